#include "report/page_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace flextip::report {
namespace {

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
      {"chi2", "Squared residuals over their variances"},
      {"F_p_over_EI", "Beam model: the port's force over the stiffness E I"},
      {"a", "Beam model: the port's place along its chord"},
      {"measurements", "Measurements that were used"}};
  const auto it = meanings.find(group);
  return it == meanings.end() ? group : it->second;
}

bool HasNumbers(const std::vector<double>& column) {
  return std::any_of(column.begin(), column.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

void AddPictureFiles(Report& report, const std::string& heading,
                     const std::vector<std::filesystem::path>& files) {
  if (files.empty()) return;
  report.AddHeading(heading);
  std::vector<std::pair<std::string, std::string>> pictures;
  pictures.reserve(files.size());
  for (const auto& file : files) pictures.emplace_back(ReadBytes(file), file.filename().string());
  report.AddPictures(pictures);
}

void AddShortTable(Report& report, const std::filesystem::path& file, const std::string& title) {
  constexpr std::size_t kRows = 60;
  if (!std::filesystem::exists(file)) return;
  const auto table = ReadResultTable(file);
  const std::size_t shown = std::min(kRows, table.Rows());
  Table out{.title = title, .header = table.names};
  if (shown < table.Rows()) {
    out.caption = "The first " + std::to_string(shown) + " of " + std::to_string(table.Rows()) +
                  " rows; all are in " + file.filename().string() + ".";
  }
  for (std::size_t r = 0; r < shown; ++r) {
    std::vector<std::string> row;
    for (const auto& column : table.texts) row.push_back(column[r]);
    out.rows.push_back(std::move(row));
  }
  report.AddTable(out);
}

std::vector<double> SecondsOf(const ResultTable& table) {
  std::vector<double> seconds;
  seconds.reserve(table.t_ns.size());
  for (const TimeNs t_ns : table.t_ns)
    seconds.push_back(static_cast<double>(t_ns - table.t_ns.front()) * 1e-9);
  return seconds;
}

std::vector<double> Scaled(const ResultTable& table, const std::string& column, double factor) {
  const auto* numbers = table.Column(column);
  if (numbers == nullptr) return {};
  std::vector<double> scaled = *numbers;
  for (double& v : scaled) v *= factor;
  return scaled;
}

FigureTrace PathTrace(const ResultTable& table, const std::string& prefix,
                      const std::string& name) {
  constexpr double kMmPerM = 1000.0;
  FigureTrace trace;
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
  if (seconds.empty()) return;
  std::vector<Figure> plots;
  for (std::size_t i = 1; i < table.names.size(); ++i) {
    if (!HasNumbers(table.numbers[i])) continue;
    const ColumnName name = TakeApart(table.names[i]);
    const std::string title = Meaning(name.group);
    auto plot =
        std::find_if(plots.begin(), plots.end(), [&](const Figure& p) { return p.title == title; });
    if (plot == plots.end()) {
      plots.push_back({.title = title, .x_label = "time (s)", .y_label = name.unit});
      plot = plots.end() - 1;
    }
    FigureTrace trace{.name = name.part, .x = seconds, .y = table.numbers[i]};
    for (double& y : trace.y) y *= name.factor;
    plot->traces.push_back(std::move(trace));
  }
  report.AddFigures(plots);
}

}  // namespace flextip::report
