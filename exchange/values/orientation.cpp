#include "exchange/values/orientation.h"

#include <fmt/format.h>

#include <cmath>

#include "core/linear_algebra.h"
#include "core/pose.h"

namespace flextip::exchange {
namespace {

constexpr double kMostOff = 1e-3;  // of unit length, or of R'R from the identity
constexpr double kOffRounding = 1e-12;

OrientationRead OfQuaternion(const std::vector<double>& v) {
  OrientationRead read{Eigen::Quaterniond(v[0], v[1], v[2], v[3]), ""};
  const double norm = read.q.norm();
  if (!(std::abs(norm - 1.0) <= kMostOff)) {
    read.problem =
        fmt::format("the quaternion has length {:.6g}, expected 1 within {}", norm, kMostOff);
  } else if (std::abs(norm - 1.0) > kOffRounding) {
    read.q.normalize();
  }
  return read;
}

OrientationRead OfMatrix(const std::vector<double>& v) {
  Eigen::Matrix3d R;
  R << v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8];
  const double off = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kMostOff) || R.determinant() < 0) {
    return {
        Eigen::Quaterniond::Identity(),
        fmt::format("R'R is off the identity by {:.3g} and det R is {:.3g}, expected a rotation "
                    "({}, 1)",
                    off, R.determinant(), kMostOff)};
  }
  if (off > kOffRounding) {
    const Svd svd(R);
    R = svd.U * svd.V.transpose();
  }
  return {Pose{R, Eigen::Vector3d::Zero()}.Quaternion(), ""};
}

Eigen::Quaterniond About(const Eigen::Vector3d& axis, double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, axis));
}

Eigen::Quaterniond WithPositiveScalar(Eigen::Quaterniond q) {
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return q;
}

}  // namespace

const std::vector<std::string>& OrientationRoles(const std::string& kind) {
  static const std::vector<std::string> quaternion{"qw", "qx", "qy", "qz"},
      matrix{"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"},
      vector{"rx", "ry", "rz"}, angles{"ax", "ay", "az"};
  if (kind == "quaternion") return quaternion;
  if (kind == "matrix") return matrix;
  return kind == "rotation-vector" ? vector : angles;
}

OrientationRead OrientationOf(const std::string& kind, const std::vector<double>& values) {
  if (kind == "quaternion") return OfQuaternion(values);
  if (kind == "matrix") return OfMatrix(values);
  const Eigen::Vector3d v(values[0], values[1], values[2]);
  if (kind == "rotation-vector") {
    const double angle = v.norm();
    if (angle == 0.0) return {};
    return {WithPositiveScalar(About(v / angle, angle)), ""};
  }
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  for (const char axis : kind.substr(6))
    q = q * About(Eigen::Vector3d::Unit(axis - 'x'), v[axis - 'x']);
  return {WithPositiveScalar(q.normalized()), ""};
}

bool IsAxis(const std::string& axis) {
  return (axis.size() == 1 || (axis.size() == 2 && axis[0] == '-')) && axis.back() >= 'x' &&
         axis.back() <= 'z';
}

std::optional<Eigen::Quaterniond> FrameAlong(const std::string& axis) {
  if (axis.empty() || axis == "x") return {};
  const int along = axis.back() - 'x';
  const double sign = axis[0] == '-' ? -1.0 : 1.0;
  Eigen::Matrix3d R;
  R.col(0) = sign * Eigen::Vector3d::Unit(along);
  R.col(1) = sign * Eigen::Vector3d::Unit((along + 1) % 3);
  R.col(2) = Eigen::Vector3d::Unit((along + 2) % 3);
  return Pose{R, Eigen::Vector3d::Zero()}.Quaternion();
}

}  // namespace flextip::exchange
