#include "core/pose.h"

namespace flextip {

Pose Pose::FromQuaternion(const Eigen::Quaterniond& q, const Eigen::Vector3d& p) {
  return {q.normalized().toRotationMatrix(), p};
}

Pose Pose::FromMatrix(const Eigen::Matrix4d& T) {
  return {T.topLeftCorner<3, 3>(), T.topRightCorner<3, 1>()};
}

Eigen::Matrix4d Pose::Matrix() const {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = R;
  T.topRightCorner<3, 1>() = p;
  return T;
}

Eigen::Quaterniond Pose::Quaternion() const {
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() *= -1.0;
  return q.normalized();
}

}  // namespace flextip
