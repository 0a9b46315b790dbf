// Small rotation tools on top of Eigen.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>

namespace flextip {

/// Returns the matrix [v]x with [v]x w = v x w.
inline Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  return Eigen::Matrix3d{{0, -v.z(), v.y()}, {v.z(), 0, -v.x()}, {-v.y(), v.x(), 0}};
}

/// Returns the rotation by the vector `w` (axis times angle, rad).
Eigen::Matrix3d ExpRotation(const Eigen::Vector3d& w);

/// Returns J with Exp(w + dw) = Exp(J dw) Exp(w) to first order.
Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& w);

/// Returns the rotation vector (rad) of `R`, the inverse of ExpRotation for angles below pi.
Eigen::Vector3d LogRotation(const Eigen::Matrix3d& R);

/// Returns the rotation without twist that takes the unit vector `from` to the unit vector `to`.
Eigen::Matrix3d RotationWithoutTwist(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Returns two unit columns that complete the unit vector `t` to a right-handed frame (t, b0, b1).
Eigen::Matrix<double, 3, 2> NormalBasis(const Eigen::Vector3d& t);

}  // namespace flextip
