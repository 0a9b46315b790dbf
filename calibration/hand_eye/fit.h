// Bundle adjustment of a hand-eye calibration: both frames, the time offset and every wrist pose
// within its noise, from the corners of all views.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "calibration/hand_eye/chain.h"
#include "calibration/hand_eye/views.h"
#include "core/matrix_types.h"

namespace flextip {

/// Standard deviations an axis.
struct HandEyeNoise {
  double corner_px = 0.1;
  double orientation_rad = 1e-3, position_m = 1e-4;

  /// Of the wrist's (dw, dp).
  Matrix6d WristCovariance(double share = 1.0) const;
};

struct FitView {
  std::vector<Correspondence> points;
  WristAtView wrist;  ///< as measured
};

struct HandEyeProblem {
  HandEyeMount mount = HandEyeMount::kEyeToHand;
  HandEyeNoise noise;
  std::vector<FitView> views;
  bool time_offset = false;  ///< wrists then move along their velocities
  bool intrinsics = false;

  /// Of the numbers in chain.h those that are unknown.
  std::vector<int> Unknowns() const;
};

struct HandEyeState {
  Pose T_FC, T_KB;
  CameraCalibration camera;
  double time_step_s = 0.0;  ///< after the time at which the wrists were measured
  std::vector<Pose> T_RW;    ///< one a view
};

/// The normal equations of one view.
struct ViewNormal {
  SharedMatrix U = SharedMatrix::Zero(kShared, kShared);
  SharedVector g = SharedVector::Zero(kShared);
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(kShared, 6);
  Matrix6d V = Matrix6d::Zero();
  Vector6d h = Vector6d::Zero();
  Vector6d wrist_step = Vector6d::Zero();  ///< from the measured wrist to the fitted one
  double corners_chi2 = 0.0, wrist_chi2 = 0.0;

  double Cost() const { return corners_chi2 + wrist_chi2; }
  /// Information on the shared numbers, the wrist marginalised.
  SharedMatrix Reduced() const;
};

/// Empty where a corner cannot be projected.
std::optional<ViewNormal> NormalOf(const HandEyeProblem& problem, const FitView& view,
                                   const CameraModel& camera, const HandEyeState& state,
                                   const Pose& T_RW);

/// What a fit says of the noises: chi2 over redundancy, which is 1 where the noise is as assumed.
struct HandEyeVariances {
  double corner = 1.0, orientation = 1.0, position = 1.0;
};

struct HandEyeFit {
  HandEyeState state;
  Eigen::MatrixXd covariance;  ///< of the unknowns
  HandEyeVariances variances;
  std::vector<Vector6d> wrist_steps;
  double cost = 0.0;
};

/// Levenberg-Marquardt with the wrists eliminated (Schur complement) from `start`, whose wrists
/// are set to the measured ones. Empty where it does not converge.
std::optional<HandEyeFit> FitHandEye(const HandEyeProblem& problem, HandEyeState start);

}  // namespace flextip
