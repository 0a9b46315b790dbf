// The worst angle between wanted and actual motion (chapter 2), watched while the robot moves.
#pragma once

#include <Eigen/Dense>
#include <array>

#include "control/controller.h"
#include "estimation/shaft_estimator.h"

namespace flextip {

/// Follows what FindWorstMotion finds, at the cost of two rods an axis of the ellipsoid in which
/// wrist, port and tip force lie: all nine axes in a cycle up to 30 Hz, fewer of faster cycles. No
/// tip force is believed that a shaft is not used for. Fixed size, allocates nothing.
class MotionGuard {
 public:
  /// Takes the ellipsoid's half axes in standard deviations, how far tissue is trusted, and the
  /// cycles' rate.
  MotionGuard(double deviations, double max_tissue_gain, double rate_hz);

  /// Returns the largest angle of (2.9) (rad) over the axes, as each was seen last, between what
  /// the controller's `J_hat` (d tip / d wrist) is asked for and what the exact rod does. Zero
  /// where the estimate has no rod, or `J_hat` is not finite.
  double Update(const Eigen::Matrix3d& J_hat, const ShaftEstimate& estimate,
                const Eigen::Vector3d& p_RW);

  void VisitState(StateText& state) {
    state(rod_);
    state(seen_rad_);
    state(axis_);
  }

 private:
  static constexpr int kAxes = 9;
  double AngleAt(const Eigen::Matrix3d& J_hat, const ShaftEstimate& estimate,
                 const Eigen::Vector3d& p_RW, const Eigen::Matrix<double, 9, 1>& shift);

  double deviations_, max_tissue_gain_;
  int axes_a_cycle_;
  ShaftRod rod_;
  std::array<double, kAxes> seen_rad_{};
  int axis_ = 0;
};

}  // namespace flextip
