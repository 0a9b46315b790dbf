// The reprojection error of known points under a pose, and its minimum near a start.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "core/pose.h"
#include "vision/camera_model.h"

namespace flextip {

/// A point of the tip frame and where it was seen.
struct Correspondence {
  Eigen::Vector3d x_E;
  Eigen::Vector2d px;
};

/// Sum of squared residuals under T_CE with its normal equations for a step (dw, dp) as in
/// MovePose.
struct ReprojectionError {
  double squared_px2 = 0.0;
  Eigen::Matrix<double, 6, 6> JtJ = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> Jtr = Eigen::Matrix<double, 6, 1>::Zero();
};

/// T_CE moved by (dw, dp): R becomes exp([dw]x) R and p becomes p + dp.
Pose MovePose(const Pose& T_CE, const Eigen::Matrix<double, 6, 1>& step);

/// The step (dw, dp) that takes `from` to `to`.
Eigen::Matrix<double, 6, 1> PoseDifference(const Pose& from, const Pose& to);

/// The covariance, or information, of a step (dw, dp) in the axes of A as it is in those of B.
Eigen::Matrix<double, 6, 6> Turned(const Eigen::Matrix<double, 6, 6>& covariance_B,
                                   const Eigen::Matrix3d& R_AB);
/// A step (dw, dp), or a gradient by one, likewise.
Eigen::Matrix<double, 6, 1> Turned(const Eigen::Matrix<double, 6, 1>& step_B,
                                   const Eigen::Matrix3d& R_AB);

/// Empty where a point falls behind the camera or out of the lens model's range.
std::optional<ReprojectionError> Reproject(const CameraModel& camera,
                                           const std::vector<Correspondence>& points,
                                           const Pose& T_CE);

struct PoseMinimum {
  Pose T_CE;
  ReprojectionError error;
};

/// Levenberg-Marquardt from `start`; empty where it does not converge.
std::optional<PoseMinimum> MinimiseReprojection(const CameraModel& camera,
                                                const std::vector<Correspondence>& points,
                                                const Pose& start, int max_iterations);

}  // namespace flextip
