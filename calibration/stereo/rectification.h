// Both pictures turned such that a point is seen in the same row of both.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>

#include "core/camera.h"
#include "core/pose.h"

namespace flextip {

/// In OpenCV's and ROS's form: R[eye] takes coordinates in the camera to the rectified camera,
/// P[eye] projects from rectified camera 0 into the rectified picture; P[1](0, 3) is -f times the
/// baseline (px m).
struct Rectification {
  std::array<Eigen::Matrix3d, 2> R;
  std::array<Eigen::Matrix<double, 3, 4>, 2> P;
  double baseline_m = 0.0;
  /// Takes (column, row, disparity, 1) to the homogeneous point in rectified camera 0.
  Eigen::Matrix4d Q() const;
};

/// Rows along the baseline, the axis as near to both cameras' as that allows, and the focal length
/// with which every pixel of the rectified pictures is seen. Throws InputError where the cameras
/// look along the baseline.
Rectification Rectify(const std::array<CameraCalibration, 2>& cameras, const Pose& T_C0C1);

/// The rectified pixel of one in the picture; empty where the lens model sees nothing.
std::optional<Eigen::Vector2d> RectifiedPixel(const Rectification& rectification, int eye,
                                              const CameraCalibration& camera,
                                              const Eigen::Vector2d& px);

}  // namespace flextip
