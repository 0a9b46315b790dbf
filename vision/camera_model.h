// A pinhole camera with lens distortion: points in front of it to pixels and back to rays.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "core/camera.h"

namespace flextip {

/// The mathematics of a CameraCalibration. Pixel (0,0) is the centre of the top-left pixel.
class CameraModel {
 public:
  /// Makes the model of `calibration`. Throws InputError where the number of coefficients does not
  /// fit the distortion model, a number is not finite, or a focal length is not positive.
  explicit CameraModel(const CameraCalibration& calibration);

  /// Returns the pixel of the point `x_C` (m, camera frame), and in `J`, if given, the 2x3
  /// derivative d(px)/d(x_C). Empty for points behind the camera (z <= 0) and beyond MaxAngle().
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& x_C,
                                         Eigen::Matrix<double, 2, 3>* J = nullptr) const;

  /// Returns the unit ray in C that is seen at `px`, to 1e-9 px. Empty where no ray within
  /// MaxAngle() is seen there.
  std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& px) const;

  const CameraCalibration& Calibration() const { return calibration_; }

  /// Returns the largest angle from the optical axis (rad) up to which the distortion is
  /// one-to-one.
  double MaxAngle() const { return max_angle_rad_; }

 private:
  Eigen::Vector2d Distort(const Eigen::Vector2d& m, Eigen::Matrix2d* J) const;
  Eigen::Vector2d DistortEquidistant(const Eigen::Vector2d& m, Eigen::Matrix2d* J) const;
  double RadialDerivative(double r) const;
  double FindMaxAngle() const;
  std::optional<Eigen::Vector3d> UnprojectEquidistant(const Eigen::Vector2d& distorted) const;

  CameraCalibration calibration_;
  /// k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, absent ones zero; equidistant uses the first four.
  Eigen::Matrix<double, 12, 1> k_ = Eigen::Matrix<double, 12, 1>::Zero();
  double max_angle_rad_ = 0.0;
};

}  // namespace flextip
