#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "reproduction/chapter4/parts.h"

namespace flextip::reproduction {
namespace {

constexpr double kSteel_kg_m = 0.035, kMass_N = 0.2 * 9.81, kSensorFromTip_m = 0.04;
const Eigen::Vector3d kPort(0.28, 0.0, 0.0), kGravity(0.0, -9.81, 0.0);

/// How the set-up is read: the mass hangs "next to the tip sensor", 40 mm from the tip.
struct Reading {
  const char* name;
  double to_mass_m;      // from the wrist
  double overhang_m;     // beyond the mass, to what counts as the tip
  double port_friction;  // coefficient
};
constexpr std::array<Reading, 4> kReadings = {{
    {"mass on the tip", 0.6, 0.0, 0.0},
    {"sensor and mass taken as the tip", 0.6 - kSensorFromTip_m, 0.0, 0.0},
    {"mass at the sensor, tip beyond it", 0.6 - kSensorFromTip_m, kSensorFromTip_m, 0.0},
    {"mass on the tip, friction 0.1 at the port", 0.6, 0.0, 0.1},
}};

Ch4Plant MakePlant(const Reading& reading) {
  simulation::PlantSetup setup;
  setup.instrument = Ch4Rod();
  setup.instrument.length_m = reading.to_mass_m;
  setup.p_RP = kPort;
  setup.weight_N_m = kSteel_kg_m * kGravity;
  setup.gravity_m_s2 = kGravity;
  setup.load.constant_N = {0.0, -kMass_N, 0.0};
  setup.effects.port_friction.coefficient = reading.port_friction;
  return Ch4Plant::Exact(setup, reading.overhang_m);
}

/// The controllers take the mass to hang on the tip, whatever the reading.
Ch4Move MoveOf(const Reading& reading, Ch4Kind kind, int direction, std::uint64_t seed) {
  Ch4Move move;
  move.kind = kind;
  move.setup.instrument = Ch4Rod();
  move.setup.instrument.length_m = reading.to_mass_m + reading.overhang_m;
  move.setup.instrument.mass_per_length_kg_m = kSteel_kg_m;
  move.setup.gravity_m_s2 = kGravity;
  move.setup.p_RP = kPort;
  move.move_m = kCh4Moves[direction];
  move.noise = {false, 0.00013, 0.00056, true, 1};  // 3.4.2, as measured
  move.reached_m = 5e-4;
  move.seed = 4 * seed + direction;
  return move;
}

constexpr std::array<Ch4Kind, 5> kTried = {Ch4Kind::kStraight, Ch4Kind::kPrintedWithLine,
                                           Ch4Kind::kPortForce, Ch4Kind::kTipForce, Ch4Kind::kRod};

int Seeds(const ReproduceOptions& options) { return options.quick ? 2 : 40; }

/// The largest deviation of the four moves, seed by seed (mm).
std::vector<double> Deviations(const Reading& reading, Ch4Kind kind,
                               const ReproduceOptions& options) {
  Ch4Plant plant = MakePlant(reading);
  // Copies start from the equilibrium; with friction each has to begin without a past.
  if (reading.port_friction == 0.0) plant.At(Eigen::Vector3d::Zero());
  std::vector<double> largest(Seeds(options));
  tbb::parallel_for(std::size_t{0}, largest.size(), [&](std::size_t s) {
    for (int direction = 0; direction < 4; ++direction) {
      const Ch4Run run =
          RunCh4Move(MoveOf(reading, kind, direction, 1000 * options.seed + s), plant);
      largest[s] = std::max(largest[s], 1e3 * run.max_m);
    }
  });
  return largest;
}

report::Figure MoveFigure(char part, int direction, std::uint64_t seed) {
  report::Figure figure;
  figure.name = fmt::format("fig-4-3{}", part);
  figure.title = fmt::format("Mass hung on the tip, {} (Fig. 4.3)",
                             direction == 0 ? "away from the port" : "up");
  figure.caption =
      "One run with the sensors' measured noise, 0.13 mm and 0.00056 rad. The axes are "
      "scaled differently.";
  figure.x_label = "x (mm)";
  figure.y_label = "y (mm)";
  const std::array<const char*, 3> colors = {"#d62728", "#1f77b4", "#2ca02c"};
  const std::array<Ch4Kind, 3> kinds = {Ch4Kind::kStraight, Ch4Kind::kPrintedWithLine,
                                        Ch4Kind::kRod};
  for (int i = 0; i < 3; ++i) {
    const Ch4Run run =
        RunCh4Move(MoveOf(kReadings[0], kinds[i], direction, seed), MakePlant(kReadings[0]));
    report::FigureTrace trace = PathTrace(run.p_RE, run.p_RE.front());
    trace.name = Name(kinds[i]);
    trace.color = colors[i];
    figure.traces.push_back(trace);
    trace.name = "";
    trace.kind = report::FigureTrace::Kind::kPoints;
    figure.traces.push_back(trace);
  }
  report::FigureTrace desired;
  desired.name = "desired";
  desired.dashed = true;
  desired.color = "#7f7f7f";
  desired.x = {0.0, 1e3 * kCh4Moves[direction].x()};
  desired.y = {0.0, 1e3 * kCh4Moves[direction].y()};
  figure.traces.push_back(desired);
  return figure;
}

}  // namespace

ChapterResult Ch4Experiment(const ReproduceOptions& options, const ChapterProgress& progress) {
  ChapterResult chapter;
  double straight_mm = 0.0;
  for (std::size_t r = 0; r < kReadings.size(); ++r) {
    for (const Ch4Kind kind : kTried) {
      const MeanSd stat = MeanSdOf(Deviations(kReadings[r], kind, options));
      std::optional<double> published;
      if (kind == Ch4Kind::kStraight) published = 1.9;
      if (kind == Ch4Kind::kPrintedWithLine) published = 1.1;
      if (r == 0 && kind == Ch4Kind::kStraight) straight_mm = stat.mean;
      chapter.rows.push_back(
          {fmt::format("4.4 quasi-static, largest deviation, {}, {}", Name(kind),
                       kReadings[r].name),
           published, stat.mean, "mm",
           fmt::format("0.2 kg and the shaft's weight; sensors' measured noise; mean "
                       "of {} runs of four moves, sd {:.2f}",
                       Seeds(options), stat.sd)});
      if (r == 0 && kind == Ch4Kind::kPrintedWithLine) {
        chapter.rows.push_back({"4.5 quasi-static, reduction of the largest deviation", 55.0,
                                100.0 * (1.0 - stat.mean / straight_mm), "%",
                                "1.1 of 1.9 mm, as the thesis itself states them, is 42 %"});
      }
    }
    progress(static_cast<double>(r + 1) / kReadings.size());
  }
  chapter.figures = {MoveFigure('a', 0, options.seed), MoveFigure('b', 2, options.seed)};
  return chapter;
}

}  // namespace flextip::reproduction
