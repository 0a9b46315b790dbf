#include "report/stream_figures.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>

#include "report/thinned_table.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBuckets = 1500;

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

}  // namespace

std::vector<Figure> StreamFigures(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "data.csv";
  const std::vector<std::string> names = ValueColumns(file);
  std::vector<ThinnedColumn> columns;
  columns.reserve(names.size());
  for (const auto& name : names) {
    columns.push_back({{name}, [](const std::vector<double>& v) { return v[0]; }});
  }
  const ThinnedTable table = ReadThinned(file, columns, "", {}, kBuckets);
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

}  // namespace flextip::report
