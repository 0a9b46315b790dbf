// The bent shaft behind an estimate.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "estimation/shaft_estimator.h"

namespace flextip {

/// A place of the shaft's centre line. In R.
struct ShapePoint {
  double s_m = 0.0;  ///< from the wrist along the shaft
  Eigen::Vector3d p_R = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();  ///< by wrist, port and tip force
};

/// Returns `count` places (2 or more), evenly from the wrist to the shaft's end, of the rod that
/// `estimate` describes, with the measured wrist `p_RW` (R, m). Empty where the estimate has no
/// shaft.
std::vector<ShapePoint> EstimatedShape(const ShaftEstimate& estimate, const Eigen::Vector3d& p_RW,
                                       int count);

}  // namespace flextip
