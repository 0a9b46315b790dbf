// The 24 moves of Fig. 2.8, by steps and by the arm in every way. Private to reproduction.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "reproduction/chapter.h"
#include "reproduction/chapter2/paths/paths.h"

namespace flextip::reproduction {

inline constexpr double kFriction_N = 0.3;
inline constexpr std::array<double, 3> kStart_z = {0.320, 0.375, 0.415};
inline constexpr std::array<const char*, 3> kStartName = {"L", "M", "N"};
inline constexpr int kGoals = 8, kMoves = 3 * kGoals;
inline constexpr std::array<std::array<int, 2>, kGoals> kWay = {
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};
inline constexpr std::array<double, 6> kSweep_N = {0.0, 0.05, 0.1, 0.2, 0.5, 1.0};

/// What acts besides the quasi-static controller, one at a time.
enum Cause : std::uint8_t {
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

/// From N to a goal 20 mm further out.
inline bool IsFar(int index) { return index >= 2 * kGoals && kWay[index % kGoals][0] > 0; }

/// On all cores. `quick`: the first two causes only, no sweep of friction.
std::vector<MoveResult> RunMoves(bool quick, const ChapterProgress& progress);

/// Figs. 2.8 for L, M and N; unless `quick`, what the causes and the size of friction do.
std::vector<report::Figure> TrajectoryFigures(const std::vector<MoveResult>& results, bool quick);

}  // namespace flextip::reproduction
