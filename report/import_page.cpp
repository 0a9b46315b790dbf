// The page of flextip import: every stream over time, thinned as it is read.
#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "report/pages.h"
#include "report/summary_parts.h"
#include "report/thinned_table.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kImportBuckets = 1500;

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

// "p_RW [m]" of "p_RW_x [m]", and "x".
std::pair<std::string, std::string> GroupAndPart(const std::string& column) {
  const auto unit = column.find(" [");
  const std::string name = column.substr(0, unit);
  const auto bar = name.rfind('_');
  if (bar == std::string::npos) return {column, name};
  return {name.substr(0, bar) + (unit == std::string::npos ? "" : column.substr(unit)),
          name.substr(bar + 1)};
}

void AddStream(Report& report, const fs::path& folder) {
  const fs::path file = folder / "data.csv";
  const std::vector<std::string> names = ValueColumns(file);
  std::vector<ThinnedColumn> columns;
  for (const auto& name : names) {
    columns.push_back({{name}, [](const std::vector<double>& v) { return v[0]; }});
  }
  const ThinnedTable table = ReadThinned(file, columns, "", {}, kImportBuckets);
  std::vector<Figure> figures;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto [group, part] = GroupAndPart(names[i]);
    auto figure = std::find_if(figures.begin(), figures.end(),
                               [&](const Figure& f) { return f.y_label == group; });
    if (figure == figures.end()) {
      figures.push_back(
          {.title = folder.filename().string(), .x_label = "time (s)", .y_label = group});
      figure = figures.end() - 1;
    }
    FigureTrace trace{.name = part};
    table.Trace(i, trace.x, trace.y);
    figure->traces.push_back(std::move(trace));
  }
  report.AddFigures(figures);
}

}  // namespace

void WriteImportReport(const fs::path& folder) {
  Report report = BeginPage(folder, "Imported recording");
  report.AddHeading("Streams over time");
  for (const char* stream : {"wrist0", "command0", "em0", "em1", "strain0", "load0"}) {
    if (fs::exists(folder / stream / "data.csv")) AddStream(report, folder / stream);
  }
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
