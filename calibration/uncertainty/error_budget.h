// How lens, hand-eye, tag offset and bending each contribute to the tip's error.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/tag_collar.h"
#include "vision/tag_detector.h"

namespace flextip {

/// What is known of the calibrations' errors; empty: not known, and not in the budget.
struct ChainCovariance {
  Eigen::MatrixXd lens;        ///< of fu, fv, cu, cv (px), then the coefficients
  Eigen::MatrixXd hand_eye;    ///< 6x6, of (dw, dp) of T_RC (rad, m)
  Eigen::MatrixXd tip_offset;  ///< 3x3, of the tip in E (m)
};

/// The shaft between collar and tip, which the tracker takes for rigid.
struct TipBending {
  Eigen::Vector3d f_R = Eigen::Vector3d::Zero();  ///< force on the tip (N)
  double stiffness_Nm2 = 0.0;
  double stiffness_sd_Nm2 = 0.0;  ///< 0: not known
};

/// One source's part. `covariance_R` of the tip in R (m^2); a bend that is not corrected counts
/// with its square.
struct BudgetPart {
  std::string name;  ///< pixels, lens, hand-eye, tip offset, bending, stiffness
  Eigen::Matrix3d covariance_R = Eigen::Matrix3d::Zero();
  bool in_total = true;
};

struct TipBudget {
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();
  Eigen::Vector3d depth_R = Eigen::Vector3d::UnitX();  ///< from the camera to the tip, unit
  std::vector<BudgetPart> parts;
  Eigen::Vector3d bend_R = Eigen::Vector3d::Zero();  ///< of the tip against the rigid shaft (m)
  /// Of all parts in the total. They are taken for independent: a hand-eye calibration made with
  /// the same lens has taken up some of the lens's error, and the truth is then less than this.
  Eigen::Matrix3d TotalCovariance() const;
};

/// Standard deviations (m) along the line of sight and in the worst direction across it.
struct DepthAndAcross {
  double depth_m = 0.0, across_m = 0.0;
};
DepthAndAcross SplitByDepth(const Eigen::Matrix3d& covariance_R, const Eigen::Vector3d& depth_R);

/// The budget of a tip that was found by the corners of `tags`. Empty where these give no pose.
std::optional<TipBudget> BudgetOfTip(const CameraCalibration& camera, const TagCollar& collar,
                                     const std::vector<TagDetection>& tags,
                                     const ChainCovariance& chain,
                                     const std::optional<TipBending>& bending = {});

/// How far a force on the tip bends it away from the straight line of a collar `distance_m` behind:
/// f L^3 / (3 E I) across the shaft, of which `axis` is the direction.
Eigen::Vector3d BendBeyondCollar(const Eigen::Vector3d& force_N, const Eigen::Vector3d& axis,
                                 double distance_m, double stiffness_Nm2);

}  // namespace flextip
