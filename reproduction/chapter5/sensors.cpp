#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "reproduction/chapter5/parts.h"
#include "reproduction/chapter5/sensor_loop.h"

namespace flextip::reproduction {
namespace {

constexpr SensorSet kSets[] = {
    {.name = "wrist only"},
    {.name = "load", .load = true},
    {.name = "strain", .strain = true},
    {.name = "EM direction", .em_direction = true},
    {.name = "vision position", .tip = true},
    {.name = "vision position, direction", .tip = true, .tip_direction = true},
    {.name = "EM", .em_direction = true, .em_position = true},
    {.name = "vision, strain", .strain = true, .tip = true},
    {.name = "vision, EM", .em_direction = true, .em_position = true, .tip = true},
    {.name = "vision, load", .load = true, .tip = true},
    {.name = "all",
     .load = true,
     .strain = true,
     .em_direction = true,
     .em_position = true,
     .tip = true,
     .tip_direction = true}};
constexpr int kSetCount = static_cast<int>(std::size(kSets));

constexpr double kOff_m = 0.003, kKnown_m = 0.0003, kDoubted_m = 0.003;

/// A column of the table. The estimator is told honestly how well the port is known, but where it
/// is said to trust a wrong one; over a window it is always in doubt.
struct Column {
  const char* name;
  SensorModel model;
  bool port_off;
  double port_prior_m;
  bool window;
};
constexpr Column kColumns[] = {
    {"straight", SensorModel::kStraight, false, kKnown_m, false},
    {"flex", SensorModel::kFlex, false, kKnown_m, false},
    {"rod", SensorModel::kRod, false, kKnown_m, false},
    {"rod, window", SensorModel::kRod, false, kDoubted_m, true},
    {"straight", SensorModel::kStraight, true, kDoubted_m, false},
    {"flex", SensorModel::kFlex, true, kDoubted_m, false},
    {"rod", SensorModel::kRod, true, kDoubted_m, false},
    {"rod, window", SensorModel::kRod, true, kDoubted_m, true},
    {"rod, trusting the wrong port", SensorModel::kRod, true, kKnown_m, false},
    {"flex, window", SensorModel::kFlex, true, kDoubted_m, true}};
constexpr int kColumnCount = static_cast<int>(std::size(kColumns));
constexpr SensorMove kMoves[] = {SensorMove::kPress, SensorMove::kLateral};
constexpr const char* kMoveNames[] = {"press", "lateral"};

/// Means over the repetitions.
struct Mean {
  double tip_mm = 0.0, path_max_mm = 0.0, path_rms_mm = 0.0, without_model = 0.0;
  int lost = 0;
};

class Table {
 public:
  Table(int repetitions, const ReproduceOptions& options, const ChapterProgress& progress) {
    const int count = kSetCount * kColumnCount * 2;
    std::mutex mutex;
    int done = 0;
    tbb::parallel_for(0, count, [&](int i) {
      Mean& mean = means_[i];
      for (int r = 0; r < repetitions; ++r) {
        Add(RunSensorCase(CaseOf(i, options.seed + std::uint64_t(r))), repetitions, mean);
      }
      const std::lock_guard lock(mutex);
      progress(++done / static_cast<double>(count));
    });
  }

  const Mean& At(int set, int column, int move) const {
    return means_[(set * kColumnCount + column) * 2 + move];
  }
  double WorstPath(int set, int column) const {
    return std::max(At(set, column, 0).path_max_mm, At(set, column, 1).path_max_mm);
  }
  double WorstTip(int set, int column) const {
    return std::max(At(set, column, 0).tip_mm, At(set, column, 1).tip_mm);
  }

 private:
  static SensorCase CaseOf(int number, std::uint64_t seed) {
    const Column& column = kColumns[number / 2 % kColumnCount];
    return {.sensors = kSets[number / 2 / kColumnCount],
            .model = column.model,
            .move = kMoves[number % 2],
            .port_off_m = column.port_off ? kOff_m : 0.0,
            .port_prior_m = column.port_prior_m,
            .window = column.window,
            .seed = seed};
  }
  static void Add(const SensorRun& run, int repetitions, Mean& mean) {
    mean.tip_mm += 1e3 * run.tip_rms_m / repetitions;
    mean.path_max_mm += 1e3 * run.path_max_m / repetitions;
    mean.path_rms_mm += 1e3 * run.path_rms_m / repetitions;
    mean.without_model += run.without_model / (repetitions * std::max(1.0, double(run.updates)));
    mean.lost += run.lost;
  }

  Mean means_[kSetCount * kColumnCount * 2];
};

const char* PortName(const Column& column) {
  return column.port_off ? "port 3 mm off" : "port right";
}

void AddTableRows(const Table& table, std::vector<TableRow>& rows) {
  for (int set = 0; set < kSetCount; ++set) {
    for (int c = 0; c < kColumnCount; ++c) {
      const Mean &press = table.At(set, c, 0), &lateral = table.At(set, c, 1);
      std::string note = fmt::format(
          "Press: tip {:.2f}, path {:.2f} at most, {:.2f} rms; lateral: {:.2f}, {:.2f}, {:.2f}.",
          press.tip_mm, press.path_max_mm, press.path_rms_mm, lateral.tip_mm, lateral.path_max_mm,
          lateral.path_rms_mm);
      const double without = std::max(press.without_model, lateral.without_model);
      if (without > 0.0)
        note += fmt::format(" {:.0f} % of the steps by the straight shaft, and said so.",
                            100 * without);
      if (press.lost + lateral.lost > 0)
        note +=
            fmt::format(" {} runs left the plant without equilibrium.", press.lost + lateral.lost);
      rows.push_back(
          {.quantity = fmt::format("Sensors: {}; {}; {}: path deviation", kSets[set].name,
                                   PortName(kColumns[c]), kColumns[c].name),
           .thesis = {},
           .flextip = table.WorstPath(set, c),
           .unit = "mm",
           .note = note});
    }
  }
}

/// How often a column's path deviation is more than 5 % and 0.02 mm above the straight shaft's with
/// the same sensors and port, of all sets and moves.
void AddNeverWorseRows(const Table& table, std::vector<TableRow>& rows) {
  for (int c = 0; c < kColumnCount; ++c) {
    if (kColumns[c].model == SensorModel::kStraight) continue;
    const int straight = kColumns[c].port_off ? 4 : 0;
    int worse = 0;
    double most = 0.0;
    std::string where;
    for (int set = 0; set < kSetCount; ++set) {
      for (int move = 0; move < 2; ++move) {
        const double ours = table.At(set, c, move).path_max_mm;
        const double theirs = table.At(set, straight, move).path_max_mm;
        if (ours <= 1.05 * theirs + 0.02) continue;
        ++worse;
        if (ours - theirs < most) continue;
        most = ours - theirs;
        where = fmt::format(" Most with {} ({}): {:.2f} mm against {:.2f}.", kSets[set].name,
                            kMoveNames[move], ours, theirs);
      }
    }
    rows.push_back({.quantity = fmt::format("Sensors: {}; {}: cases worse than straight",
                                            PortName(kColumns[c]), kColumns[c].name),
                    .thesis = {},
                    .flextip = worse,
                    .note = fmt::format("Of {}.", 2 * kSetCount) + where});
  }
}

report::Figure Bars(const Table& table, const std::string& name, bool port_off, bool tip) {
  report::Figure figure{
      .name = name,
      .title = fmt::format("{} by sensors and controller, {}", tip ? "Tip error" : "Path deviation",
                           port_off ? "port 3 mm off" : "port right"),
      .caption = fmt::format(
          "{}; the worse of a press and a lateral move, mean over the repetitions. Beside the "
          "sensors named the wrist's pose is measured. Logarithmic.",
          tip ? "Rms of the tip the controller went by" : "Largest deviation of the true tip"),
      .x_label = "sensors",
      .y_label = tip ? "tip error (mm)" : "path deviation (mm)",
      .log_y = true};
  for (int c = 0; c < kColumnCount; ++c) {
    if (kColumns[c].port_off != port_off) continue;
    report::FigureTrace bars{.name = kColumns[c].name, .kind = report::FigureTrace::Kind::kBars};
    for (int set = 0; set < kSetCount; ++set) {
      bars.labels.emplace_back(kSets[set].name);
      bars.y.push_back(tip ? table.WorstTip(set, c) : table.WorstPath(set, c));
    }
    figure.traces.push_back(bars);
  }
  return figure;
}

}  // namespace

ChapterResult Ch5Sensors(const ReproduceOptions& options, const ChapterProgress& progress) {
  const Table table(options.quick ? 1 : 8, options, progress);
  ChapterResult result;
  AddTableRows(table, result.rows);
  AddNeverWorseRows(table, result.rows);
  result.figures = {Bars(table, "sensors-a", false, false), Bars(table, "sensors-b", true, false),
                    Bars(table, "sensors-c", true, true)};
  return result;
}

}  // namespace flextip::reproduction
