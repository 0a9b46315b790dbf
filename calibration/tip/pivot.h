// Pivot calibration: a body B turned about a fixed point gives that point in B (the tip) and in R.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <string>
#include <vector>

#include "core/matrix_types.h"
#include "core/pose.h"
#include "core/time_series.h"

namespace flextip {

struct PivotPose {
  TimeNs t_ns = 0;
  Pose T_RB;
  Matrix6d covariance = Matrix6d::Zero();  ///< of (dw, dp) in R, T_RB = (exp([dw]x) R, p + dp)
};

struct PivotOptions {
  /// How far the stated noise is off is found from the residuals: one factor for position and one
  /// for orientation (whose error grows with the lever to the tip), or one for both. Two are taken
  /// only where they do not predict poses left out worse than one: an error that follows the pose,
  /// as a tracker's scale, can pass for noise of one kind.
  bool separate_noise = true;
  double least_turn_over_noise = 4.0;  ///< a turn below so many times its noise counts as none
  double max_sd_m = 0.005;             ///< a tip less certain than this is not named
};

enum class PivotStatus : std::uint8_t {
  kOk,
  kTooFewPoses,   ///< fewer than five
  kUnobservable,  ///< the motion leaves the tip unknown, see `unobservable`
  kNoPivot,       ///< fewer than 60 % of the poses agree on any fixed point, or it is 10 m away
};
const char* Name(PivotStatus status);

struct PivotResidual {
  Eigen::Vector3d r_R = Eigen::Vector3d::Zero();  ///< tip by this pose less pivot (m), in R
  /// The same by a fit without this pose, to the other poses that the fit to all uses.
  Eigen::Vector3d heldout_R = Eigen::Vector3d::Zero();
  double sigmas = 0.0;  ///< length of r_R in standard deviations, by the noise found
  bool used = true;
  std::string reason;  ///< why not
};

/// The gain of a further turn: `poses` more poses, `angle_rad` about `axis_B` from the middle of
/// the present poses.
struct PivotAdvice {
  Eigen::Vector3d axis_B = Eigen::Vector3d::UnitX();
  double angle_rad = 0.0;
  int poses = 0;
  double sd_after_m = 0.0;  ///< root of the trace of the tip's covariance
};

struct PivotResult {
  PivotStatus status = PivotStatus::kTooFewPoses;
  std::string unobservable;  ///< in a user's words
  Eigen::Vector3d p_BE = Eigen::Vector3d::Zero(), p_R = Eigen::Vector3d::Zero();  ///< m
  Matrix6d covariance = Matrix6d::Zero();  ///< of (p_BE, p_R); the noise is that found
  double position_noise_scale = 1.0, orientation_noise_scale = 1.0;  ///< found over stated
  bool separate_noise = false;    ///< whether these two were found apart
  double correlation_time = 1.0;  ///< in poses; `covariance` counts so many as one
  std::vector<PivotResidual> residuals;
  int used = 0;
  double rms_m = 0.0, heldout_rms_m = 0.0;  ///< per component, of those used
  double algebraic_rms_m = 0.0;             ///< per component, one linear step with all poses
  /// How far each direction of B was turned (rms, rad), ascending, and those directions as columns.
  Eigen::Vector3d turn_rad = Eigen::Vector3d::Zero();
  Eigen::Matrix3d turn_axes_B = Eigen::Matrix3d::Identity();
  PivotAdvice advice;

  bool IsUsable() const { return status == PivotStatus::kOk; }
};

/// Starts from the algebraic one-step solution (Yaniv 2015), made robust by least absolute
/// residuals; then outliers are taken out one set after the other and the rest is fitted by maximum
/// likelihood with errors in position and orientation. Covariances are positive definite.
PivotResult CalibratePivot(const std::vector<PivotPose>& poses, const PivotOptions& options = {});

}  // namespace flextip
