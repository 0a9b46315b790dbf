#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <mutex>

#include "reproduction/ch2_parts.h"
#include "reproduction/ch2_traj_paths.h"

namespace flextip {
namespace {

constexpr double kFriction_N = 0.3;
constexpr std::array<double, 3> kStart_z = {0.320, 0.375, 0.415};
constexpr std::array<const char*, 3> kStartName = {"L", "M", "N"};
constexpr int kGoals = 8, kMoves = 3 * kGoals;
constexpr std::array<std::array<int, 2>, kGoals> kWay = {
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
constexpr std::array<double, 6> kSweep_N = {0.0, 0.05, 0.1, 0.2, 0.5, 1.0};

/// What acts besides the quasi-static controller, one at a time.
enum Cause {
  kDynamics,
  kFriction,
  kFrictionAlone,
  kWeight,
  kEncoders,
  kLinks,
  kAccumulated,
  kAccumulatedFriction,
  kCauses
};

ArmRig Rig(Cause cause) {
  ArmRig rig;
  switch (cause) {
    case kFriction:
      rig.friction_N = kFriction_N;
      break;
    case kFrictionAlone:  // a fifth of every mass, a faster loop and no integral
      rig.friction_N = kFriction_N;
      rig.body = {0.21, 0.21, 0.2 * rig.body.inertia1_kg_m2, 0.2 * rig.body.inertia2_kg_m2,
                  0.2 * rig.body.wrist_mass_kg};
      rig.shaft_mass_kg *= 0.2;
      rig.pid.ki_Nm_rad_s = 0.0;
      rig.rate_hz = 5000.0;
      rig.substeps = 4;
      break;
    case kWeight:
      rig.gravity_m_s2 = 9.81;
      break;
    case kEncoders:
      rig.encoder_rad = 0.03e-3 / 0.21;  // 0.03 mm at the wrist, as its maker states
      break;
    case kLinks:
      rig.link_error = 0.01;
      break;
    case kAccumulated:
    case kAccumulatedFriction:
      rig.joint_goal = JointGoal::kAccumulated;
      rig.gain = 0.001;
      rig.pid = {10.0, 10.0, 0.5};
      rig.friction_N = cause == kAccumulated ? 0.0 : kFriction_N;
      break;
    case kDynamics:
    case kCauses:
      break;
  }
  return rig;
}

struct Tried {
  TrajectoryPath path;
  double deviation_mm = 0.0;
};

/// One move, by steps and by the arm in every way.
struct MoveResult {
  TrajectoryMove move;
  TrajectoryPath quasi_static;
  double away_mm = 0.0;
  std::array<Tried, kCauses> by_cause;
  std::array<double, kSweep_N.size()> sweep_mm{};  // from N only
};

TrajectoryMove Move(int index) {
  TrajectoryMove move;
  move.p_start = {kStart_z[index / kGoals], 0.0};
  move.p_goal =
      move.p_start + 0.02 * Eigen::Vector2d(kWay[index % kGoals][0], kWay[index % kGoals][1]);
  return move;
}

/// From N to a goal 20 mm further out.
bool IsFar(int index) { return index >= 2 * kGoals && kWay[index % kGoals][0] > 0; }

MoveResult RunMove(int index, bool quick) {
  MoveResult result;
  result.move = Move(index);
  result.quasi_static = QuasiStaticPath(result.move, 0.01);
  result.away_mm = 1e3 * MovesAway(result.quasi_static, result.move.p_goal);
  const auto run = [&](ArmRig rig) {
    if (quick) rig.longest_s = 3.0;
    Tried tried;
    tried.path = DynamicPath(result.move, rig);
    tried.deviation_mm = 1e3 * LargestDistance(tried.path, result.quasi_static);
    return tried;
  };
  for (int cause = 0; cause < kCauses; ++cause) {
    if (quick && cause > kFriction) break;
    result.by_cause[cause] = run(Rig(static_cast<Cause>(cause)));
  }
  for (std::size_t i = 0; i < kSweep_N.size() && !quick && index >= 2 * kGoals; ++i) {
    ArmRig rig = Rig(kFriction);
    rig.friction_N = kSweep_N[i];
    result.sweep_mm[i] = run(rig).deviation_mm;
  }
  return result;
}

std::vector<MoveResult> RunMoves(bool quick, const ChapterProgress& progress) {
  std::vector<MoveResult> results(kMoves);
  std::mutex reporting;
  int done = 0;
  tbb::parallel_for(0, kMoves, [&](int i) {
    results[i] = RunMove(i, quick);
    const std::lock_guard lock(reporting);
    progress(static_cast<double>(++done) / kMoves);
  });
  return results;
}

double Largest(const std::vector<MoveResult>& results, Cause cause, int first, int end) {
  double largest = 0.0;
  for (int i = first; i < end; ++i) {
    largest = std::max(largest, results[i].by_cause[cause].deviation_mm);
  }
  return largest;
}

/// Least deviation of the three far paths from N, and the largest of its five others.
struct Contrast {
  double least_far_mm = 1e9, largest_other_mm = 0.0;
};
Contrast OfN(const std::vector<MoveResult>& results, Cause cause) {
  Contrast contrast;
  for (int i = 2 * kGoals; i < kMoves; ++i) {
    const double mm = results[i].by_cause[cause].deviation_mm;
    if (IsFar(i)) {
      contrast.least_far_mm = std::min(contrast.least_far_mm, mm);
    } else {
      contrast.largest_other_mm = std::max(contrast.largest_other_mm, mm);
    }
  }
  return contrast;
}

int CountIf(const std::vector<MoveResult>& results, bool (*holds)(const MoveResult&)) {
  return static_cast<int>(std::count_if(results.begin(), results.end(), holds));
}

void AddSteps(const std::vector<MoveResult>& results, std::vector<TableRow>& rows) {
  rows.push_back({"2.3.2 moves by quasi-static steps that reach their goal", 24,
                  CountIf(results, [](const MoveResult& r) { return r.quasi_static.reached; })});
  rows.push_back({"2.3.2 moves by steps that move away before they converge", 1,
                  CountIf(results, [](const MoveResult& r) { return r.away_mm > 0.05; }), "",
                  "the thesis names (435, 0); here its two neighbours (435, +-20) do it too"});
  for (int goal : {0, 1, 7}) {
    const MoveResult& r = results[2 * kGoals + goal];
    rows.push_back({fmt::format("2.3.2 way back on the path to ({:.0f}, {:.0f})",
                                1e3 * r.move.p_goal.x(), 1e3 * r.move.p_goal.y()),
                    {},
                    r.away_mm,
                    "mm",
                    "by how much the distance to the goal grows again; by steps of gain 0.01"});
  }
}

void AddDeviations(const std::vector<MoveResult>& results, std::vector<TableRow>& rows) {
  const auto add = [&](Cause cause, const std::string& what, const std::string& note) {
    for (int s = 0; s < 3; ++s) {
      rows.push_back({fmt::format("2.3.2 largest distance from the steps' path, {}, from {}", what,
                                  kStartName[s]),
                      {},
                      Largest(results, cause, s * kGoals, (s + 1) * kGoals),
                      "mm",
                      note});
    }
  };
  add(kDynamics, "inertia and PID", "no friction: slow motion takes the dynamics away");
  add(kFriction, "with friction", "0.3 N along the shaft at the port");
}

/// Far paths that are further from the steps' than every other of the 24.
int FarFromSteps(const std::vector<MoveResult>& results) {
  double other = 0.0;
  int count = 0;
  for (int i = 0; i < kMoves; ++i) {
    if (!IsFar(i)) other = std::max(other, results[i].by_cause[kFriction].deviation_mm);
  }
  for (int i = 0; i < kMoves; ++i) count += results[i].by_cause[kFriction].deviation_mm > other;
  return count;
}

double ChangeByLinks(const std::vector<MoveResult>& results) {
  double largest = 0.0;
  for (const MoveResult& r : results) {
    largest =
        std::max(largest, LargestDistance(r.by_cause[kLinks].path, r.by_cause[kDynamics].path));
  }
  return 1e3 * largest;
}

int LargerAngles(const std::vector<MoveResult>& results) {
  return CountIf(results, [](const MoveResult& r) {
    constexpr double kNear_m = 0.005;
    return LargestHeadingError(r.by_cause[kFriction].path, r.move.p_goal, kNear_m) >
           LargestHeadingError(r.quasi_static, r.move.p_goal, kNear_m) + 0.02;
  });
}

void AddCauses(const std::vector<MoveResult>& results, std::vector<TableRow>& rows) {
  const auto add = [&](Cause cause, const std::string& what, const std::string& note) {
    const Contrast contrast = OfN(results, cause);
    rows.push_back({fmt::format("2.4 N, least of the three far paths, {}", what),
                    {},
                    contrast.least_far_mm,
                    "mm",
                    note});
    rows.push_back({fmt::format("2.4 N, largest of the five others, {}", what),
                    {},
                    contrast.largest_other_mm,
                    "mm"});
  };
  rows.push_back({"2.4 paths from N that do not closely follow the steps'", 3,
                  FarFromSteps(results), "",
                  "those to (435, 0), (435, 20) and (435, -20), with 0.3 N of friction; counted: "
                  "further off than every other of the 24"});
  add(kFriction, "friction", "0.3 N with inertia and PID");
  add(kFrictionAlone, "friction alone",
      "a fifth of the inertia, no integral: what is left is friction");
  add(kDynamics, "dynamics alone", "inertia and PID without friction");
  add(kWeight, "shaft's weight alone",
      "0.11 N that nothing balances, no friction: picks out the same three, and more sharply");
  add(kEncoders, "encoders alone", "0.03 mm at the wrist");
  add(kAccumulatedFriction, "friction, goals accumulated",
      "joint goals that add up instead of starting from the measured joints (3.4)");
  add(kAccumulated, "dynamics, goals accumulated", "");
  rows.push_back(
      {"2.4 change of the recorded paths by links 1 % too long",
       {},
       ChangeByLinks(results),
       "mm",
       "the tip by forward kinematics follows the controller's own geometry: an error of it "
       "cannot show in these paths"});
  rows.push_back(
      {"2.4 paths with a larger angle to the goal than by steps",
       {},
       LargerAngles(results),
       "",
       "\"sometimes greater\" in the thesis; with friction, of 24, up to 5 mm from the goal"});
}

FigureTrace Line(const TrajectoryPath& path, const std::string& name, bool dashed) {
  FigureTrace trace;
  trace.name = name;
  trace.dashed = dashed;
  trace.color = dashed ? "#7f7f7f" : "#1f77b4";
  for (const Eigen::Vector2d& p : path.p_tip) {
    if (!trace.x.empty() &&
        std::hypot(1e3 * p.x() - trace.x.back(), 1e3 * p.y() - trace.y.back()) < 0.05)
      continue;
    trace.x.push_back(1e3 * p.x());
    trace.y.push_back(1e3 * p.y());
  }
  return trace;
}

FigureTrace Points(const std::string& name, const std::string& color, const std::string& symbol) {
  FigureTrace trace;
  trace.name = name;
  trace.kind = FigureTrace::Kind::kPoints;
  trace.color = color;
  trace.symbol = symbol;
  return trace;
}

Figure PathFigure(const std::vector<MoveResult>& results, int start) {
  Figure figure;
  figure.name = fmt::format("fig-2-8{}", static_cast<char>('l' + start));
  figure.title = fmt::format("From {} to eight goals (Fig. 2.8)", kStartName[start]);
  figure.caption =
      "Dashed: quasi-static steps of gain 0.01. Solid: arm with inertia, 1000 Hz PID and "
      "0.3 N of friction at the port.";
  figure.x_label = "z (mm)";
  figure.y_label = "y (mm)";
  figure.equal_axes = true;
  FigureTrace goals = Points("goals", "#d62728", "circle"),
              from = Points("start", "#000000", "circle");
  for (int i = start * kGoals; i < (start + 1) * kGoals; ++i) {
    const MoveResult& r = results[i];
    const bool first = i == start * kGoals;
    figure.traces.push_back(Line(r.quasi_static, first ? "quasi-static" : "", true));
    figure.traces.push_back(
        Line(r.by_cause[kFriction].path, first ? "arm with friction" : "", false));
    goals.x.push_back(1e3 * r.move.p_goal.x());
    goals.y.push_back(1e3 * r.move.p_goal.y());
    from.x = {1e3 * r.move.p_start.x()};
    from.y = {1e3 * r.move.p_start.y()};
  }
  figure.traces.push_back(goals);
  figure.traces.push_back(from);
  return figure;
}

Figure CauseFigure(const std::vector<MoveResult>& results) {
  Figure figure;
  figure.name = "fig-2-8-causes";
  figure.title = "What takes the paths from N off the quasi-static ones";
  figure.caption =
      "Largest distance from the path by steps, one cause at a time: inertia and PID; 0.3 N of "
      "friction besides; the shaft's 0.11 N, unbalanced, without friction. A move whose shaft "
      "left the port is cut off there.";
  figure.x_label = "goal";
  figure.y_label = "distance (mm)";
  figure.log_y = true;
  for (const auto& [cause, name] :
       {std::pair{kDynamics, "dynamics alone"}, std::pair{kFriction, "with friction"},
        std::pair{kWeight, "with the shaft's weight"}}) {
    FigureTrace bars;
    bars.name = name;
    bars.kind = FigureTrace::Kind::kBars;
    for (int i = 2 * kGoals; i < kMoves; ++i) {
      bars.labels.push_back(fmt::format("({:.0f}, {:.0f})", 1e3 * results[i].move.p_goal.x(),
                                        1e3 * results[i].move.p_goal.y()));
      bars.y.push_back(results[i].by_cause[cause].deviation_mm);
    }
    figure.traces.push_back(bars);
  }
  return figure;
}

Figure SweepFigure(const std::vector<MoveResult>& results) {
  Figure figure;
  figure.name = "fig-2-8-friction";
  figure.title = "Friction and the paths from N";
  figure.caption = "Solid: the three goals further out. Dashed: the five others.";
  figure.x_label = "friction at the port (N)";
  figure.y_label = "largest distance from the path by steps (mm)";
  for (int i = 2 * kGoals; i < kMoves; ++i) {
    FigureTrace line;
    const bool first = i == 2 * kGoals || i == 2 * kGoals + 2;
    if (first) line.name = IsFar(i) ? "goals at z = 435" : "the five others";
    line.color = IsFar(i) ? "#d62728" : "#7f7f7f";
    line.dashed = !IsFar(i);
    line.x.assign(kSweep_N.begin(), kSweep_N.end());
    line.y.assign(results[i].sweep_mm.begin(), results[i].sweep_mm.end());
    figure.traces.push_back(line);
  }
  return figure;
}

}  // namespace

ChapterResult Ch2Trajectories(const ReproduceOptions& options, const ChapterProgress& progress) {
  const std::vector<MoveResult> results = RunMoves(options.quick, progress);
  ChapterResult chapter;
  AddSteps(results, chapter.rows);
  AddDeviations(results, chapter.rows);
  if (!options.quick) AddCauses(results, chapter.rows);
  for (int start = 0; start < 3; ++start) chapter.figures.push_back(PathFigure(results, start));
  if (!options.quick) {
    chapter.figures.push_back(CauseFigure(results));
    chapter.figures.push_back(SweepFigure(results));
  }
  return chapter;
}

}  // namespace flextip
