// Small rotation tools on top of Eigen.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>

namespace flextip {

/// The matrix [v]x with [v]x w = v x w.
inline Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// The rotation by the vector `w` (axis times angle, rad).
inline Eigen::Matrix3d ExpRotation(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-12) return Eigen::Matrix3d::Identity() + Skew(w);
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

/// The rotation vector (rad) of `R`, the inverse of ExpRotation for angles below pi.
inline Eigen::Vector3d LogRotation(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd a(R);
  return a.angle() * a.axis();
}

/// The rotation without twist that takes the unit vector `from` to the unit vector `to`.
inline Eigen::Matrix3d RotationWithoutTwist(const Eigen::Vector3d& from,
                                            const Eigen::Vector3d& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
}

/// Two unit columns that complete the unit vector `t` to a right-handed frame (t, b0, b1).
inline Eigen::Matrix<double, 3, 2> NormalBasis(const Eigen::Vector3d& t) {
  Eigen::Index smallest = 0;
  t.cwiseAbs().minCoeff(&smallest);
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = t.cross(Eigen::Vector3d::Unit(smallest)).normalized();
  basis.col(1) = t.cross(basis.col(0));
  return basis;
}

}  // namespace flextip
