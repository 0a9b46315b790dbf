#include <fmt/format.h>

#include <algorithm>

#include "reproduction/chapter2/parts.h"
#include "reproduction/chapter2/paths/moves.h"

namespace flextip::reproduction {
namespace {

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

}  // namespace

ChapterResult Ch2Trajectories(const ReproduceOptions& options, const ChapterProgress& progress) {
  const std::vector<MoveResult> results = RunMoves(options.quick, progress);
  ChapterResult chapter;
  AddSteps(results, chapter.rows);
  AddDeviations(results, chapter.rows);
  if (!options.quick) AddCauses(results, chapter.rows);
  chapter.figures = TrajectoryFigures(results, options.quick);
  return chapter;
}

}  // namespace flextip::reproduction
