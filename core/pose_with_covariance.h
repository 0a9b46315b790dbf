// A pose and how uncertain it is.
#pragma once

#include <Eigen/Dense>

#include "core/pose.h"

namespace flextip {

/// T_AB with the 6x6 covariance of (dw, dp), both in A: T_AB = (exp([dw]x) R, p + dp), in rad and
/// m. All zero: known exactly, or not known, as the owner says.
struct PoseWithCovariance {
  Pose pose;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

}  // namespace flextip
