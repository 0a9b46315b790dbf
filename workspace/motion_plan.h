// Paths of the tip that trade length against motion errors (thesis 2.4), and a controller's motion
// along them.
#pragma once

#include <vector>

#include "workspace/map.h"
#include "workspace/path_planner.h"

namespace flextip {

/// A metre costs 1 + weight * DirectionError: the error of the direction travelled counts, not the
/// worst of all directions.
struct PlanOptions {
  MotionFault fault = MotionFault::kStray;
  double weight = 1.0;
  double spacing_m = 0.005;
};

/// Returns the cost in the map's slice. Interpolates the matrices A between the map's points; no
/// path goes where one of the four around a place is missing.
template <int N>
PathCost MotionCost(const WorkspaceMap<N>& map, const PlanOptions& options);

/// Returns the cheapest path between two places of the slice, anywhere in the map.
template <int N>
Path PlanMotion(const WorkspaceMap<N>& map, const Eigen::Vector2d& start,
                const Eigen::Vector2d& goal, const PlanOptions& options);

enum class FollowStatus {
  kOk,
  kStartOutside,  ///< the tip cannot be at the path's beginning
  kLost,          ///< the arm or the shaft reached an impossible place
  kNotArrived,    ///< a move did not end within `arrived_m` of its goal
};
const char* Name(FollowStatus status);

/// As in 2.3.2: moves to goals `move_m` apart along the path, each made in small steps.
struct FollowOptions {
  double move_m = 0.02;
  double gain = 0.02;  ///< gain of the steps, in place of the setup's
  double arrived_m = 5e-4;
  int cycles_per_move = 2000;
};

template <int N>
struct Followed {
  FollowStatus status = FollowStatus::kStartOutside;
  std::vector<VectorN<N>> tips = {};  ///< after each cycle
  double max_deviation_m = 0.0;       ///< from the path
  double mean_deviation_m = 0.0;      ///< over the distance that the tip went
};

/// Follows a path in space by quasi-static steps (2.3), with the tip's position known: each cycle
/// moves the joints by k J_hat^-1 (x_d - x), and the next goal follows once the last is reached.
template <int N>
Followed<N> FollowPath(const MapSetup<N>& setup, const std::vector<VectorN<N>>& path,
                       const FollowOptions& options);

}  // namespace flextip
