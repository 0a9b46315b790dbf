// A place that arithmetic can work with.
#pragma once

#include <Eigen/Dense>

namespace flextip {

/// No place of a robot, a port or a tip is farther from its frame's origin along an axis (m).
/// Beyond, rounding comes near the size of a step, and squares overflow at last.
inline constexpr double kFarthestPlace_m = 1e3;

/// Returns whether a place is finite and within kFarthestPlace_m.
inline bool IsPlace(const Eigen::Vector3d& p_m) {
  return p_m.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= kFarthestPlace_m;
}

}  // namespace flextip
