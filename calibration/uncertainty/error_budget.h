// How lens, hand-eye, tag offset and bending each contribute to the tip's error.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/tag_collar.h"
#include "vision/tags/detector.h"

namespace flextip {

/// The known covariances of the calibrations; empty: not known, and not in the budget.
struct ChainCovariance {
  Eigen::MatrixXd lens;        ///< of fu, fv, cu, cv (px), then the coefficients
  Eigen::MatrixXd hand_eye;    ///< 6x6, of (dw, dp) of T_RC (rad, m)
  Eigen::MatrixXd tip_offset;  ///< 3x3, of the tip in E (m)
};

/// The bend of the shaft between collar and tip. With the force measured (`load0`) the tracker
/// corrects the bend; the errors of force and stiffness remain. Else the tracker takes the shaft
/// for rigid, and is off by all of the bend.
struct TipBending {
  Eigen::Vector3d f_R = Eigen::Vector3d::Zero();         ///< force on the tip (N)
  Eigen::Vector3d weight_N_m = Eigen::Vector3d::Zero();  ///< of the shaft per length, in R
  double stiffness_Nm2 = 0.0;
  double stiffness_sd_Nm2 = 0.0;  ///< 0: not known
  bool corrected = false;
  double force_noise_N = 0.0;  ///< standard deviation per axis
};

/// One source's part. `covariance_R` of the tip in R (m^2); a bend that is not corrected counts
/// with its square. Not in the total: a stiffness that would matter if the bend were corrected, a
/// bend that is.
struct BudgetPart {
  std::string name;  ///< pixels, lens, hand-eye, tip offset, bending, load, stiffness
  Eigen::Matrix3d covariance_R = Eigen::Matrix3d::Zero();
  bool in_total = true;
};

struct TipBudget {
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();
  Eigen::Vector3d depth_R = Eigen::Vector3d::UnitX();  ///< from the camera to the tip, unit
  std::vector<BudgetPart> parts;
  Eigen::Vector3d bend_R = Eigen::Vector3d::Zero();  ///< of the tip against the rigid shaft (m)
  /// Returns the covariance (m^2) of all parts in the total, taken for independent. A hand-eye
  /// calibration made with the same lens has taken up some of the lens's error; the true covariance
  /// is then less.
  Eigen::Matrix3d TotalCovariance() const;
};

/// Standard deviations (m) along the line of sight and in the worst direction across it.
struct DepthAndAcross {
  double depth_m = 0.0, across_m = 0.0;
};
DepthAndAcross SplitByDepth(const Eigen::Matrix3d& covariance_R, const Eigen::Vector3d& depth_R);

/// Returns the budget of a tip found by the corners of `tags`. Empty where these give no pose.
std::optional<TipBudget> BudgetOfTip(const CameraCalibration& camera, const TagCollar& collar,
                                     const std::vector<TagDetection>& tags,
                                     const ChainCovariance& chain,
                                     const std::optional<TipBending>& bending = {});

}  // namespace flextip
