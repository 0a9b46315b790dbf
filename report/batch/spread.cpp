#include "report/batch/spread.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/median.h"
#include "report/labels.h"
#include "report/result_files.h"

namespace flextip::report {
namespace {

constexpr std::size_t kMostFigures = 5;

bool IsTime(const std::string& name) { return name == "seconds" || name == "frames_per_second"; }

/// The key behind its path: "rod-track/rms_deviation_m".
std::string KeyOf(const std::string& column) { return column.substr(column.rfind('/') + 1); }

using Point = std::pair<double, std::string>;  // value, item

std::vector<Point> PointsOf(const ResultTable& table, std::size_t column) {
  const std::vector<std::string>* names = table.Texts("name");
  std::vector<Point> points;
  for (std::size_t i = 0; i < table.Rows(); ++i) {
    const double value = table.numbers[column][i];
    if (std::isfinite(value)) points.emplace_back(value, names ? (*names)[i] : "");
  }
  std::sort(points.begin(), points.end());
  return points;
}

std::vector<std::size_t> ColumnsThatDiffer(const ResultTable& table, const std::string& command) {
  std::vector<std::size_t> columns;
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    const std::string& name = table.names[c];
    if (name == "name" || name == "input" || name == "exit_code" || name == "message") continue;
    const auto points = PointsOf(table, c);
    if (points.size() > 1 && points.front().first < points.back().first) columns.push_back(c);
  }
  std::stable_sort(columns.begin(), columns.end(), [&](std::size_t a, std::size_t b) {
    const std::string &left = table.names[a], &right = table.names[b];
    if (IsTime(left) != IsTime(right)) return IsTime(right);
    return IsBefore(KeyOf(left), KeyOf(right), command);
  });
  return columns;
}

Figure FigureOf(const std::string& column, const std::vector<Point>& points,
                const std::string& command) {
  const std::string key = KeyOf(column);
  const auto spoken = [&](double value) { return SpokenValue(key, value); };
  const SpokenUnit unit = UnitOf(key);
  std::vector<double> values;
  for (const Point& point : points) values.push_back(point.first);
  Figure figure{.title = column == key
                             ? Label(key, command)
                             : column.substr(0, column.rfind('/')) + ", " + Label(key, command),
                .x_label = "items, from the smallest value",
                .y_label = unit.unit};
  figure.caption = fmt::format("Median {}; from {} ({}) to {} ({}).", spoken(Median(values)),
                               spoken(points.front().first), points.front().second,
                               spoken(points.back().first), points.back().second);
  FigureTrace trace{.kind = FigureTrace::Kind::kPoints};
  for (std::size_t i = 0; i < values.size(); ++i) {
    trace.x.push_back(static_cast<double>(i + 1));
    trace.y.push_back(unit.factor * values[i]);
  }
  figure.traces.push_back(std::move(trace));
  return figure;
}

}  // namespace

std::vector<std::string> SpreadColumns(const std::filesystem::path& table,
                                       const std::string& command) {
  const ResultTable read = ReadResultTable(table);
  std::vector<std::string> names;
  for (const std::size_t c : ColumnsThatDiffer(read, command)) names.push_back(read.names[c]);
  return names;
}

std::vector<Figure> SpreadOf(const std::filesystem::path& table, const std::string& command) {
  const ResultTable read = ReadResultTable(table);
  std::vector<Figure> figures;
  for (const std::size_t c : ColumnsThatDiffer(read, command)) {
    if (figures.size() < kMostFigures || read.names[c] == "seconds") {
      figures.push_back(FigureOf(read.names[c], PointsOf(read, c), command));
    }
  }
  return figures;
}

}  // namespace flextip::report
