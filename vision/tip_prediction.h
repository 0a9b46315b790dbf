// Where the tip is expected before a frame has been looked at.
#pragma once

#include <Eigen/Dense>

#include "core/pose.h"

namespace flextip {

/// The tip frame's pose as something other than this frame's picture says it (wrist and shaft
/// model, or motion).
struct TipPrediction {
  Pose T_RE;
  /// Of (dw, dp) in R (rad, m): the true pose is (exp([dw]x) R, p + dp).
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

}  // namespace flextip
