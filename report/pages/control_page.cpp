// The page of flextip control: the tip and its goal from session0/cycles.csv, thinned, and the
// times of the cycles.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "report/pages.h"
#include "report/result_files.h"
#include "report/stops/stops.h"
#include "report/summary_parts.h"
#include "report/thinned_table.h"

namespace flextip::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kBuckets = 1500;
constexpr double kMmPerM = 1000.0;
constexpr const char* kTip = "#0072b2";
constexpr const char* kGoal = "#d55e00";

/// A number of the cycles in which nothing held the robot.
ThinnedColumn WhileMoving(std::vector<std::string> sources,
                          double (*value)(const std::vector<double>&)) {
  sources.emplace_back("hold");
  return {std::move(sources), [value](const std::vector<double>& v) {
            return v.back() == 0.0 ? kMmPerM * value(v) : std::nan("");
          }};
}

double First(const std::vector<double>& v) { return v[0]; }
double Distance(const std::vector<double>& v) {
  return std::hypot(v[0] - v[3], v[1] - v[4], v[2] - v[5]);
}

std::vector<std::string> Parts(const std::string& name) {
  return {name + " [m]_0", name + " [m]_1", name + " [m]_2"};
}

/// The first numbers of the buckets, a gap where the robot was held.
FigureTrace PathOf(const ThinnedTable& table, std::size_t column) {
  FigureTrace trace;
  for (const ThinnedBucket& bucket : table.buckets) {
    trace.x.push_back(bucket.columns[column].first);
    trace.y.push_back(bucket.columns[column + 1].first);
    trace.z.push_back(bucket.columns[column + 2].first);
  }
  return trace;
}

void AddTip(Report& report, const fs::path& cycles) {
  if (!fs::exists(cycles)) return;
  std::vector<ThinnedColumn> columns;
  std::vector<std::string> both;
  for (const char* name : {"p_RE", "goal"}) {
    for (const std::string& part : Parts(name)) {
      columns.push_back(WhileMoving({part}, First));
      both.push_back(part);
    }
  }
  columns.push_back(WhileMoving(both, Distance));
  const std::size_t distance = columns.size() - 1;
  const ThinnedTable table = ReadThinned(cycles, columns, "", {}, kBuckets);
  const bool moved = std::any_of(
      table.buckets.begin(), table.buckets.end(),
      [&](const auto& bucket) { return std::isfinite(bucket.columns[distance].least); });
  if (!moved) return;
  report.AddHeading("The tip");
  Figure over_time{.title = "Distance of the tip from its goal",
                   .caption =
                       "The tip as the controller took it, in each cycle in which nothing "
                       "held the robot.",
                   .x_label = "time (s)",
                   .y_label = "distance (mm)"};
  FigureTrace trace{.color = kTip};
  table.Trace(distance, trace.x, trace.y);
  over_time.traces.push_back(std::move(trace));
  Figure path{.title = "Path of the tip, in R",
              .x_label = "x (mm)",
              .y_label = "y (mm)",
              .z_label = "z (mm)",
              .equal_axes = true};
  FigureTrace tip = PathOf(table, 0), goal = PathOf(table, 3);
  tip.name = "tip";
  tip.color = kTip;
  goal.name = "goal";
  goal.color = kGoal;
  goal.dashed = true;
  path.traces = {std::move(goal), std::move(tip)};
  report.AddFigures({over_time, path});
}

void AddTimes(Report& report, const Json& summary) {
  Table table{.title = "Times of the cycles (ms)",
              .header = {"", "half of them within", "99 % within", "99.9 % within", "longest"}};
  const std::pair<const char*, const char*> spreads[] = {
      {"wake_late", "cycle due to begun"},
      {"work", "cycle begun to command sent"},
      {"sample_to_command", "wrist's sample to command sent"}};
  for (const auto& [key, name] : spreads) {
    const Json spread = summary.value(key, Json::object());
    if (spread.value("count", 0L) == 0) continue;
    std::vector<std::string> row{name};
    for (const char* part : {"p50_s", "p99_s", "p99.9_s", "worst_s"})
      row.push_back(fmt::format("{:.3f}", 1e3 * spread.value(part, std::nan(""))));
    table.rows.push_back(std::move(row));
  }
  report.AddTable(table);
}

/// The counts of a map that are not 0, the greatest first.
void AddCounts(Report& report, const Json& counts, const std::string& title,
               const std::string& what) {
  std::vector<std::pair<long, std::string>> rows;
  for (const auto& [name, count] : counts.items())
    if (count.is_number() && count.get<long>() > 0) rows.emplace_back(count.get<long>(), name);
  std::stable_sort(rows.begin(), rows.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  Table table{.title = title, .header = {what, "cycles"}};
  for (const auto& [count, name] : rows) table.rows.push_back({name, std::to_string(count)});
  if (!rows.empty()) report.AddTable(table);
}

}  // namespace

void WriteControlReport(const fs::path& folder) {
  const Json summary = Json::parse(ReadBytes(folder / "summary.json"));
  Report report =
      BeginPage(folder, "A controlled run", [&](Report& page) { AddStops(page, folder); });
  AddCounts(report, summary.value("holds", Json::object()), "Held", "why");
  AddCounts(report, summary.value("limited", Json::object()), "Limited", "by");
  AddTip(report, folder / "session0/cycles.csv");
  report.AddHeading("Times");
  AddTimes(report, summary);
  if (fs::exists(folder / "figures.json")) report.AddFigureFile(folder / "figures.json");
  report.Write(folder / "report.html");
}

}  // namespace flextip::report
