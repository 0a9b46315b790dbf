// The worst angle between wanted and actual motion (chapter 2), watched while the robot moves.
#pragma once

#include <Eigen/Dense>
#include <array>

#include "control/controller.h"
#include "estimation/shaft_estimator.h"

namespace flextip {

/// Follows what FindWorstMotion finds, at the cost of two rods a cycle. A cycle looks at one axis
/// of the ellipsoid in which wrist, port and tip force lie, so that nine cycles look at all. Fixed
/// size, allocates nothing.
class MotionGuard {
 public:
  /// Takes the ellipsoid's half axes in standard deviations, and how far tissue is trusted.
  MotionGuard(double deviations, double max_tissue_gain)
      : deviations_(deviations), max_tissue_gain_(max_tissue_gain) {}

  /// Returns the largest angle of (2.9) (rad) over the estimate and the axes seen in the last nine
  /// cycles, between what the controller's `J_hat` (d tip / d wrist) is asked for and what the
  /// exact rod does. Zero where the estimate has no rod, or `J_hat` is not finite.
  double Update(const Eigen::Matrix3d& J_hat, const ShaftEstimate& estimate,
                const Eigen::Vector3d& p_RW);

 private:
  static constexpr int kAxes = 9;
  double AngleAt(const Eigen::Matrix3d& J_hat, const ShaftEstimate& estimate,
                 const Eigen::Vector3d& p_RW, const Eigen::Matrix<double, 9, 1>& shift);

  double deviations_, max_tissue_gain_;
  ShaftRod rod_;
  std::array<double, kAxes> seen_rad_{};
  int axis_ = 0;
};

}  // namespace flextip
