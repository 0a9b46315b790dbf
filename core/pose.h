// Rigid transforms. A variable T_AB takes coordinates in frame B to coordinates in frame A.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>

namespace flextip {

/// T_AB: x_A = R x_B + p. `R` is R_AB, `p` is p_AB: the origin of B in A (m).
struct Pose {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();

  /// Returns the pose of the rotation `q` (normalised here) and the origin `p`.
  static Pose FromQuaternion(const Eigen::Quaterniond& q, const Eigen::Vector3d& p);
  static Pose FromMatrix(const Eigen::Matrix4d& T);
  Eigen::Matrix4d Matrix() const;
  /// Returns the rotation, unit, with a non-negative scalar part.
  Eigen::Quaterniond Quaternion() const;
  Pose Inverse() const { return {R.transpose(), -(R.transpose() * p)}; }
};

inline Pose operator*(const Pose& T_AB, const Pose& T_BC) {
  return {T_AB.R * T_BC.R, T_AB.R * T_BC.p + T_AB.p};
}
inline Eigen::Vector3d operator*(const Pose& T_AB, const Eigen::Vector3d& x_B) {
  return T_AB.R * x_B + T_AB.p;
}

}  // namespace flextip
