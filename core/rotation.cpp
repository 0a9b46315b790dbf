#include "core/rotation.h"

#include <cmath>

namespace flextip {

Eigen::Matrix3d ExpRotation(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-12) return Eigen::Matrix3d::Identity() + Skew(w);
  return Eigen::AngleAxisd(angle, w / angle).toRotationMatrix();
}

Eigen::Vector3d LogRotation(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd a(R);
  return a.angle() * a.axis();
}

Eigen::Matrix3d RotationWithoutTwist(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  // As Eigen's FromTwoVectors, without the singular value decomposition it brings for opposite
  // directions.
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  const double c = b.dot(a);
  // Twice the cosine of half the angle; the second form loses all digits near opposite directions.
  const double s = c < -0.5 ? (a + b).norm() : std::sqrt(2.0 * (1.0 + c));
  Eigen::Quaterniond q;
  if (s < 1e-9) {  // opposite: half a turn about any normal
    q.w() = 0.0;
    q.vec() = NormalBasis(a).col(0);
  } else {
    q.w() = 0.5 * s;
    q.vec() = a.cross(b) * (1.0 / s);
  }
  return q.normalized().toRotationMatrix();
}

Eigen::Matrix3d LeftJacobian(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d W = Skew(w);
  if (angle < 1e-4) return Eigen::Matrix3d::Identity() + 0.5 * W + W * W / 6.0;
  const double square = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / square * W +
         (angle - std::sin(angle)) / (square * angle) * W * W;
}

Eigen::Matrix<double, 3, 2> NormalBasis(const Eigen::Vector3d& t) {
  Eigen::Index smallest = 0;
  t.cwiseAbs().minCoeff(&smallest);
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = t.cross(Eigen::Vector3d::Unit(smallest)).normalized();
  basis.col(1) = t.cross(basis.col(0));
  return basis;
}

}  // namespace flextip
