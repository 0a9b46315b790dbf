// The direction of a tip in the covariance of a ROS 2 pose. Private to dds.
#pragma once

#include <Eigen/Dense>
#include <cmath>

namespace flextip::live {

/// Position first, then rotations about the fixed axes of R.
using Matrix6d = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

/// The direction of the shaft, x of the tip's frame, with its noise per axis across it (rad). Zero:
/// not seen.
struct SeenDirection {
  Eigen::Vector3d d_RE = Eigen::Vector3d::Zero();
  double noise_rad = 0.0;
};

/// A rotation about an axis with this variance (rad2) is not known.
inline constexpr double kUnknownRotation_rad2 = 10.0;
/// From this deviation on (rad) a direction was not seen.
inline constexpr double kUnseen_rad = 3.0;

/// Returns the direction of a pose; a negative variance, as of no known covariance, has none.
inline SeenDirection DirectionOf(const Eigen::Matrix3d& R_RE, const Matrix6d& covariance) {
  const Eigen::Vector3d d = R_RE.col(0);
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d * d.transpose();
  const double variance = 0.5 * (across * covariance.bottomRightCorner<3, 3>() * across).trace();
  if (!(variance >= 0.0 && variance < kUnseen_rad * kUnseen_rad)) return {};
  return {d, std::sqrt(variance)};
}

/// Returns the rotations' covariance of a direction: `noise_rad` across it, unknown about it.
inline Eigen::Matrix3d CovarianceOf(const SeenDirection& seen) {
  if (seen.d_RE.isZero()) return kUnknownRotation_rad2 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d along = seen.d_RE * seen.d_RE.transpose();
  return seen.noise_rad * seen.noise_rad * (Eigen::Matrix3d::Identity() - along) +
         kUnknownRotation_rad2 * along;
}

}  // namespace flextip::live
