// The lens models of core/camera.h with their derivatives by the coefficients. Private to
// calibration: vision/camera_model.h projects, and differentiates by the point.
#pragma once

#include <Eigen/Core>

#include "core/camera.h"

namespace flextip {

/// A place on the plane z = 1 as the lens bends it, in focal lengths from the principal point.
struct LensDerivative {
  Eigen::Vector2d d;
  Eigen::Matrix2d by_m;  ///< of `d`, by the undistorted place
  /// Of `d`, by the coefficients: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, or k1 to k4 of a fisheye.
  /// Columns beyond the model's terms mean nothing.
  Eigen::Matrix<double, 2, 12> by_k;
};

/// Distorts `m` = (x/z, y/z). `k` has `terms` coefficients: 4, 5, 8 or 12 of OpenCV's, or 4 of
/// Kannala and Brandt's: theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8).
LensDerivative DifferentiateLens(Distortion distortion, const double* k, int terms,
                                 const Eigen::Vector2d& m);

}  // namespace flextip
