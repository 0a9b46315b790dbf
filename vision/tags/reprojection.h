// The reprojection error of known points under a pose, and its minimum near a start.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "core/pose.h"
#include "vision/camera_model.h"

namespace flextip {

/// A point of the tip frame E (m) and its place in the picture (px).
struct Correspondence {
  Eigen::Vector3d x_E;
  Eigen::Vector2d px;
};

/// Sum of squared residuals under T_CE, with the normal equations JtJ step = Jtr of a step (dw, dp)
/// as in MovePose.
struct ReprojectionError {
  double squared_px2 = 0.0;
  Eigen::Matrix<double, 6, 6> JtJ = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> Jtr = Eigen::Matrix<double, 6, 1>::Zero();
};

/// Returns T_CE moved by (dw, dp): R becomes exp([dw]x) R, p becomes p + dp.
Pose MovePose(const Pose& T_CE, const Eigen::Matrix<double, 6, 1>& step);

/// Returns the step (dw, dp) that takes `from` to `to`.
Eigen::Matrix<double, 6, 1> PoseDifference(const Pose& from, const Pose& to);

/// Returns the covariance (or information) of a step (dw, dp), given in the axes of B, in the axes
/// of A.
Eigen::Matrix<double, 6, 6> Turned(const Eigen::Matrix<double, 6, 6>& covariance_B,
                                   const Eigen::Matrix3d& R_AB);
/// Returns a step (dw, dp), or a gradient by one, given in the axes of B, in the axes of A.
Eigen::Matrix<double, 6, 1> Turned(const Eigen::Matrix<double, 6, 1>& step_B,
                                   const Eigen::Matrix3d& R_AB);

/// Returns the error of all points under `T_CE`. Empty where a point is behind the camera or out of
/// the lens model's range.
std::optional<ReprojectionError> Reproject(const CameraModel& camera,
                                           const std::vector<Correspondence>& points,
                                           const Pose& T_CE);

struct PoseMinimum {
  Pose T_CE;
  ReprojectionError error;
};

/// Minimises the error by Levenberg-Marquardt from `start`. Empty where it does not converge.
std::optional<PoseMinimum> MinimiseReprojection(const CameraModel& camera,
                                                const std::vector<Correspondence>& points,
                                                const Pose& start, int max_iterations);

}  // namespace flextip
