#include "report/page_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/error.h"
#include "report/diagnose/parts.h"

namespace flextip::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kOpenRows = 15;  // a longer table is folded

Json ReadSummary(const std::filesystem::path& folder) {
  const auto path = folder / "summary.json";
  try {
    auto json = Json::parse(ReadBytes(path));
    if (!json.is_object()) throw InputError::At(path.string(), 0, "not an object");
    return json;
  } catch (const Json::exception& e) {
    throw InputError::At(path.string(), 0, e.what());
  }
}

/// A value as people read it; what is neither number nor text is shown as JSON.
std::string Shown(const std::string& key, const Json& value) {
  if (value.is_number()) return SpokenValue(key, value.get<double>());
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  return value.is_null() ? "–" : value.dump();
}

bool IsScalar(const Json& value) { return value.is_number() || value.is_boolean(); }

/// A list or a map whose items are all maps is a table: their keys are its columns.
bool IsTable(const Json& value) {
  return value.is_structured() && !value.empty() &&
         std::all_of(value.begin(), value.end(), [](const Json& v) { return v.is_object(); });
}

std::vector<std::string> ColumnKeys(const Json& items) {
  std::vector<std::string> keys;
  for (const auto& item : items) {
    for (const auto& [key, value] : item.items()) {
      if (value.is_structured()) continue;
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    }
  }
  return keys;
}

// JSON's keys are in the alphabet's order: what a row is about goes first, words last.
void PutNameFirst(std::vector<std::string>& keys) {
  const auto rank = [](const std::string& key) {
    static const std::vector<std::string> names = {"view",  "image", "left",   "right",
                                                   "part",  "lens",  "motion", "parameter",
                                                   "field", "hold",  "pose",   "seconds"};
    static const std::vector<std::string> words = {"reason", "left_reason", "right_reason"};
    if (std::find(names.begin(), names.end(), key) != names.end()) return 0;
    return std::find(words.begin(), words.end(), key) != words.end() ? 2 : 1;
  };
  std::stable_sort(keys.begin(), keys.end(),
                   [&](const std::string& a, const std::string& b) { return rank(a) < rank(b); });
}

// Without its unit, which is in every cell, unless another column is called the same.
std::string ColumnTitle(const std::string& key, const std::vector<std::string>& keys) {
  if (key == "seconds") return "time";
  const std::string title = SpokenName(key);
  const auto alike = std::count_if(keys.begin(), keys.end(), [&](const std::string& other) {
    return SpokenName(other) == title;
  });
  if (alike < 2) return title;
  std::string full = key;
  std::replace(full.begin(), full.end(), '_', ' ');
  return full;
}

void AddJsonTable(Report& report, const std::string& name, const Json& items) {
  auto keys = ColumnKeys(items);
  PutNameFirst(keys);
  Table table;
  table.title = SpokenName(name);
  if (items.is_object()) table.header.emplace_back("");
  for (const auto& key : keys) table.header.push_back(ColumnTitle(key, keys));
  for (const auto& [label, item] : items.items()) {
    std::vector<std::string> row;
    if (items.is_object()) row.push_back(label);
    for (const auto& key : keys) row.push_back(item.contains(key) ? Shown(key, item[key]) : "–");
    table.rows.push_back(std::move(row));
  }
  if (table.rows.size() <= kOpenRows) return report.AddTable(table);
  report.AddHtml(FoldedTableHtml(fmt::format("{} ({})", table.title, table.rows.size()),
                                 table.header, table.rows));
}

/// A column's name taken apart: "p_RE_x [m]" is the part "x" of "p_RE", shown in mm.
struct ColumnName {
  std::string group, part, unit;
  double factor = 1.0;
};

ColumnName TakeApart(const std::string& name) {
  const auto bracket = name.find(" [");
  const std::string bare = name.substr(0, bracket);
  ColumnName column{.group = bare, .part = bare, .unit = ""};
  if (bracket != std::string::npos && name.ends_with("]")) {
    column.unit = name.substr(bracket + 2, name.size() - bracket - 3);
  }
  if (column.unit == "m") {
    column.unit = "mm";
    column.factor = 1000.0;
  }
  const auto cut = bare.rfind('_');
  if (cut == std::string::npos || cut == 0 || bare.size() - cut > 3) return column;
  const std::string ending = bare.substr(cut + 1);
  if (ending.empty() || ending.find_first_not_of("wxyz") != std::string::npos) return column;
  column.group = bare.substr(0, cut);
  column.part = ending;
  return column;
}

/// What flextip's columns mean, for those who do not know the names by heart.
std::string Meaning(const std::string& group) {
  static const std::map<std::string, std::string> meanings{
      {"p_RE", "Tip position"},
      {"sd_RE", "Standard deviation of the tip position"},
      {"p_RP", "Port position"},
      {"sd_RP", "Standard deviation of the port position"},
      {"p_RW", "Wrist position"},
      {"d_RE", "Direction of the shaft at the tip"},
      {"f_tip", "Force on the tip"},
      {"sd_f_tip", "Standard deviation of the force on the tip"},
      {"s_port", "Port along the shaft"},
      {"chi2", "Squared residuals over their variances"}};
  const auto it = meanings.find(group);
  return it == meanings.end() ? group : it->second;
}

bool HasNumbers(const std::vector<double>& column) {
  return std::any_of(column.begin(), column.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

Report TitledPage(const std::filesystem::path& folder,
                  const std::function<std::string(const std::string& command)>& title) {
  const Json summary = ReadSummary(folder);
  const auto text = [&](const char* key) {
    return summary.contains(key) ? Shown(key, summary[key]) : std::string();
  };
  return Report(title(text("command")),
                fmt::format("{}   (flextip {})", text("command"), text("version")));
}

void AddSummaryFigures(Report& report, const std::filesystem::path& folder) {
  std::vector<std::pair<std::string, std::string>> figures;
  const Json summary = ReadSummary(folder);
  for (const auto& [key, value] : summary.items()) {
    if (IsScalar(value)) figures.emplace_back(SpokenName(key), Shown(key, value));
  }
  report.AddFigures(figures);
}

void AddSummaryTables(Report& report, const std::filesystem::path& folder) {
  const Json summary = ReadSummary(folder);
  for (const auto& [key, value] : summary.items()) {
    if (key != "warnings" && IsTable(value)) AddJsonTable(report, key, value);
  }
}

Report BeginPage(const std::filesystem::path& folder, const std::string& title) {
  Report report = TitledPage(folder, [&](const std::string&) { return title; });
  AddSummaryFigures(report, folder);
  const Json summary = ReadSummary(folder);
  std::vector<std::string> warnings;
  for (const auto& w : summary.value("warnings", Json::array())) warnings.push_back(Shown("", w));
  report.AddWarnings(warnings);
  const bool has_tables = std::any_of(summary.items().begin(), summary.items().end(),
                                      [](const auto& item) { return IsTable(item.value()); });
  if (has_tables) report.AddHeading("Results");
  AddSummaryTables(report, folder);
  return report;
}

void AddPictureFiles(Report& report, const std::string& heading,
                     const std::vector<std::filesystem::path>& files) {
  if (files.empty()) return;
  report.AddHeading(heading);
  std::vector<std::pair<std::string, std::string>> pictures;
  pictures.reserve(files.size());
  for (const auto& file : files) pictures.emplace_back(ReadBytes(file), file.filename().string());
  report.AddPictures(pictures);
}

std::vector<double> SecondsOf(const ResultTable& table) {
  std::vector<double> seconds;
  if (table.texts.empty() || table.texts.front().empty()) return seconds;
  seconds.reserve(table.Rows());
  const long long first = std::atoll(table.texts.front().front().c_str());
  for (const auto& stamp : table.texts.front()) {
    seconds.push_back(static_cast<double>(std::atoll(stamp.c_str()) - first) * 1e-9);
  }
  return seconds;
}

std::vector<double> Scaled(const ResultTable& table, const std::string& column, double factor) {
  const auto* numbers = table.Column(column);
  if (numbers == nullptr) return {};
  std::vector<double> scaled = *numbers;
  for (double& v : scaled) v *= factor;
  return scaled;
}

PlotTrace PathTrace(const ResultTable& table, const std::string& prefix, const std::string& name) {
  constexpr double kMmPerM = 1000.0;
  PlotTrace trace;
  trace.name = name;
  trace.x = Scaled(table, prefix + "_x", kMmPerM);
  trace.y = Scaled(table, prefix + "_y", kMmPerM);
  trace.z = Scaled(table, prefix + "_z", kMmPerM);
  if (trace.x.size() != trace.y.size() || trace.x.size() != trace.z.size()) {
    trace.x = trace.y = trace.z = {};
  }
  return trace;
}

void AddColumnsOverTime(Report& report, const ResultTable& table) {
  const auto seconds = SecondsOf(table);
  std::vector<Plot> plots;
  for (std::size_t i = 1; i < table.names.size(); ++i) {
    if (!HasNumbers(table.numbers[i])) continue;
    const ColumnName name = TakeApart(table.names[i]);
    const std::string title = Meaning(name.group);
    auto plot =
        std::find_if(plots.begin(), plots.end(), [&](const Plot& p) { return p.title == title; });
    if (plot == plots.end()) {
      const auto label = name.unit.empty() ? name.group : name.group + " (" + name.unit + ")";
      plots.push_back({.title = title, .x_label = "time (s)", .y_label = label});
      plot = plots.end() - 1;
    }
    PlotTrace trace{.name = name.part, .x = seconds, .y = table.numbers[i]};
    for (double& y : trace.y) y *= name.factor;
    plot->traces.push_back(std::move(trace));
  }
  for (const auto& plot : plots) report.AddPlot(plot);
}

}  // namespace flextip::report
