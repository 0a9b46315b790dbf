// The worst angle between a wished and the actual motion of the tip (chapter 2) while the shaft is
// anywhere within the doubt of its estimate.
#pragma once

#include <Eigen/Dense>
#include <numbers>

#include "control/controller.h"
#include "estimation/shaft_estimator.h"

namespace flextip {

struct WorstMotion {
  bool found = false;                   ///< the controller has a Jacobian, and the estimate a rod
  double angle_rad = std::numbers::pi;  ///< the largest; pi: some shaft there has no equilibrium
  double angle_at_estimate_rad = std::numbers::pi;      ///< by the controller's model alone
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< the worst wished motion; unit, in R
};

/// Finds the largest angle of (2.9) between what the controller `J_hat` (d tip / d wrist) is asked
/// for and what the exact rod does. The rod's wrist, port and tip force are anywhere within
/// `deviations` standard deviations (an ellipsoid) of `estimate`, `p_RW` is the measured wrist (R,
/// m), and the tissue is as stiff as controllers believe it. The angle of each rod is exact; the
/// rod is found by a climb from the ellipsoid's axes. Some 100 rods: milliseconds.
WorstMotion FindWorstMotion(const Eigen::Matrix3d& J_hat, const ShaftEstimate& estimate,
                            const Eigen::Vector3d& p_RW, const ControllerOptions& options,
                            double deviations);

}  // namespace flextip
