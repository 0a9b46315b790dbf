// The chain camera - F - wrist - K - board of a hand-eye calibration, with its derivatives.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "calibration/hand_eye/hand_eye.h"
#include "core/pose.h"
#include "vision/camera_model.h"
#include "vision/tags/reprojection.h"

namespace flextip {

/// The numbers that all views share, in this order: steps (dw, dp) of T_FC and of T_KB, the time
/// offset (s), fu, fv, cu, cv (px).
constexpr int kShared = 17, kTimeColumn = 12, kIntrinsicsColumn = 13;
using SharedVector = Eigen::VectorXd;  ///< kShared
using SharedMatrix = Eigen::MatrixXd;  ///< kShared x kShared

/// T_FK of a wrist at T_RW.
Pose WristInChain(HandEyeMount mount, const Pose& T_RW);

/// T_CB of the chain.
Pose BoardInCamera(HandEyeMount mount, const Pose& T_FC, const Pose& T_KB, const Pose& T_RW);

/// How T_CB steps (dw, dp, in C) with T_FC (columns 0-5), T_KB (6-11) and T_RW (12-17), each by
/// its (dw, dp); exact at zero.
Eigen::Matrix<double, 6, 18> ChainJacobian(HandEyeMount mount, const Pose& T_FC, const Pose& T_KB,
                                           const Pose& T_RW);

/// Residuals (px) of a view's corners, rows in pairs, with their derivatives.
struct ChainResiduals {
  Eigen::VectorXd r_px;     ///< projected less seen
  Eigen::MatrixXd J;        ///< kShared columns; the time's column is zero: it moves T_RW
  Eigen::MatrixXd J_wrist;  ///< 6 columns, of a step of T_RW
};

/// Empty where a corner falls behind the camera or out of the lens model's range.
std::optional<ChainResiduals> ResidualsOfChain(HandEyeMount mount, const CameraModel& camera,
                                               const std::vector<Correspondence>& points,
                                               const Pose& T_FC, const Pose& T_KB,
                                               const Pose& T_RW);

}  // namespace flextip
