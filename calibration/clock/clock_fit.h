// Offset and rate of one clock against another, by the motion both streams share.
#pragma once

#include <Eigen/Dense>

#include "calibration/clock/predictors.h"

namespace flextip {

/// Reference time = t + offset + rate (t - origin) for a target's time t.
struct ClockFit {
  bool converged = false;
  double offset_s = 0.0, rate = 0.0, origin_s = 0.0;
  double play_m = 0.0;  ///< between the measured wrist and the shaft's, where it could be told
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of offset (s) and rate
  double misfit = 1.0;  ///< residual over variance of the target's values
  /// Twice the log likelihood of the residuals' innovations, a sample, and how much of it the
  /// reference has brought: without it, each residual would be predicted by its own past alone.
  double likelihood = 0.0, brought = 0.0;
  double parameters = 0.0;  ///< that were free, the small ones by their part
  std::size_t samples = 0;
};

/// A few steps with the play held: offset, rate and likelihood, to choose among starts. `linear`
/// leaves the small predictors out: all of them explain a short slow motion at any offset.
ClockFit QuickFit(const Motion& target, Predictors& reference, double offset_s, double play_m,
                  bool linear);

/// Fits clock, play and prediction of the target's values by Gauss-Newton from `start_offset_s`.
/// Residuals are whitened by an autoregression for each principal axis, so that what drifts or
/// breathes does not count where the motion is faster; Huber's weights on the innovations. The
/// origin is the middle of the overlap. The covariance is the larger of the formal one and that of
/// the scores' scatter over blocks of time, with a rate of 0 within 3e-4, plus the model's error: a
/// part of how far play and the predictors that are not linear move the clock.
ClockFit FitClock(const Motion& target, Predictors& reference, double start_offset_s);

}  // namespace flextip
