// Paths of the tip that trade length against motion errors (thesis 2.4), and what a controller makes
// of them.
#pragma once

#include <vector>

#include "workspace/map.h"
#include "workspace/path_planner.h"

namespace flextip {

/// A metre costs 1 + weight * DirectionError: what matters is the error of the direction
/// travelled, not the worst of all directions.
struct PlanOptions {
  Measure measure = Measure::kAngle;  ///< the angle in rad
  double weight = 1.0;
  double spacing_m = 0.005;
};

/// In the map's slice. The matrices A between the map's points are interpolated; where one of the
/// four around a place is missing no path may go.
template <int N>
PathCost MotionCost(const WorkspaceMap<N>& map, const PlanOptions& options);

/// The cheapest path between two places of the slice, anywhere in the map.
template <int N>
Path PlanMotion(const WorkspaceMap<N>& map, const Eigen::Vector2d& start,
                const Eigen::Vector2d& goal, const PlanOptions& options);

enum class FollowStatus {
  kOk,
  kStartOutside,  ///< the tip cannot be at the path's beginning
  kLost,          ///< the arm or the shaft came to where it cannot be
  kNotArrived,    ///< still further than `arrived_m` from the goal
};
const char* Name(FollowStatus status);

struct FollowOptions {
  double step_m = 0.005;  ///< of the desired position along the path, each cycle
  int settle_cycles = 500;
  double arrived_m = 1e-4;
};

template <int N>
struct Followed {
  FollowStatus status = FollowStatus::kStartOutside;
  std::vector<VectorN<N>> tips = {};  ///< after each cycle
  double max_deviation_m = 0.0;       ///< from the path
  double mean_deviation_m = 0.0;      ///< over the cycles until the desired position is the goal
};

/// Quasi-static steps (2.3) along a path in space, with the tip's position known: each cycle the
/// desired position moves on by a step and the arm by k J_hat^-1 (x_d - x).
template <int N>
Followed<N> FollowPath(const MapSetup<N>& setup, const std::vector<VectorN<N>>& path,
                       const FollowOptions& options);

}  // namespace flextip
