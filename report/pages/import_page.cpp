// The page of flextip import: what was assumed, and every stream over time, thinned as it is read.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "report/pages.h"
#include "report/result_files.h"
#include "report/summary_parts.h"
#include "report/thinned_table.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kImportBuckets = 1500;

std::string TextAt(const Json& json, const char* key) {
  if (!json.contains(key)) return "";
  return json[key].is_string() ? json[key].get<std::string>() : json[key].dump();
}

void AddStreamTable(Report& report, const Json& summary) {
  Table table;
  table.title = "Streams, as they were read back";
  table.header = {"stream",   "samples",     "time",    "rate",
                  "first at", "first value", "read as", "left out"};
  for (const Json& stream : summary.value("streams", Json::array())) {
    table.rows.push_back({TextAt(stream, "name"), TextAt(stream, "samples"),
                          fmt::format("{:.6g} s", stream.value("seconds", 0.0)),
                          fmt::format("{:.4g} Hz", stream.value("rate_hz", 0.0)),
                          fmt::format("{:.3f} s", 1e-9 * stream.value("first_time_ns", 0.0)),
                          TextAt(stream, "first_value"), TextAt(stream, "units"),
                          TextAt(stream, "skipped")});
  }
  report.AddTable(table);
}

void AddAssumed(Report& report, const Json& summary) {
  Table table;
  table.title = "Assumed: neither the files nor the options say so";
  table.header = {"item", "taken as"};
  for (const Json& item : summary.value("assumed", Json::array())) {
    table.rows.push_back({TextAt(item, "name"), TextAt(item, "is")});
  }
  if (!table.rows.empty()) report.AddTable(table);
}

// The columns of numbers behind the time: "#timestamp [ns],p_RW_x [m],...".
std::vector<std::string> ValueColumns(const fs::path& file) {
  std::ifstream in(file);
  std::string head, name;
  std::getline(in, head);
  std::istringstream names(head);
  std::vector<std::string> columns;
  while (std::getline(names, name, ',')) columns.push_back(name);
  if (!columns.empty()) columns.erase(columns.begin());
  return columns;
}

// "p_RW [m]" of "p_RW_x [m]", and "x"; "[rad]" and "q1" of "q1 [rad]".
std::pair<std::string, std::string> GroupAndPart(const std::string& column) {
  const auto bracket = column.find(" [");
  const std::string name = column.substr(0, bracket);
  std::string unit = bracket == std::string::npos ? "" : column.substr(bracket);
  if (unit == " []") unit.clear();
  const auto bar = name.rfind('_');
  if (bar == std::string::npos) return {"joints" + unit, name};
  return {name.substr(0, bar) + unit, name.substr(bar + 1)};
}

std::vector<Figure> FiguresOf(const fs::path& folder) {
  const fs::path file = folder / "data.csv";
  const std::vector<std::string> names = ValueColumns(file);
  std::vector<ThinnedColumn> columns;
  columns.reserve(names.size());
  for (const auto& name : names) {
    columns.push_back({{name}, [](const std::vector<double>& v) { return v[0]; }});
  }
  const ThinnedTable table = ReadThinned(file, columns, "", {}, kImportBuckets);
  std::vector<Figure> figures;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto [group, part] = GroupAndPart(names[i]);
    auto figure = std::find_if(figures.begin(), figures.end(),
                               [&g = group](const Figure& f) { return f.y_label == g; });
    if (figure == figures.end()) {
      figure = figures.insert(
          figure, {.title = folder.filename().string(), .x_label = "time (s)", .y_label = group});
    }
    FigureTrace trace{.name = part};
    table.Trace(i, trace.x, trace.y);
    figure->traces.push_back(std::move(trace));
  }
  return figures;
}

}  // namespace

void WriteImportReport(const fs::path& folder) {
  const Json summary = Json::parse(ReadBytes(folder / "summary.json"));
  Report report = TitledPage(folder, "Imported recording");
  report.AddHtml(HeadHtml(HeadOf(folder)));
  AddFindings(report, folder);
  report.AddWarnings(WarningsNotSaid(folder));
  AddStreamTable(report, summary);
  AddAssumed(report, summary);
  report.AddHeading("Streams over time");
  for (const Json& stream : summary.value("streams", Json::array())) {
    const std::string name = TextAt(stream, "name");
    if (name.starts_with("cam") || !fs::exists(folder / name / "data.csv")) continue;
    report.AddFigures(FiguresOf(folder / name));
  }
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
