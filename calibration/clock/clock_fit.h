// Offset and rate of one clock against another, by the motion both streams share.
#pragma once

#include <Eigen/Dense>

#include "calibration/clock/smooth_motion.h"

namespace flextip {

/// Reference time = t + offset + rate (t - origin) for a target's time t.
struct ClockFit {
  bool converged = false;
  double offset_s = 0.0, rate = 0.0, origin_s = 0.0;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of offset (s) and rate
  double misfit = 1.0;       ///< residual over variance of the target's values
  double independent = 0.0;  ///< residuals that count, as many as if they were independent
  std::size_t samples = 0;
};

/// Fits the clock and the linear prediction of the target's values by the reference, by
/// Gauss-Newton from `start_offset_s` with Huber's weights. The origin is the middle of the
/// overlap. The covariance counts residuals that remember themselves (Newey and West, Econometrica
/// 55, 1987) and a rate of 0 within 3e-4.
ClockFit FitClock(const Motion& target, const SmoothMotion& reference, double start_offset_s);

}  // namespace flextip
