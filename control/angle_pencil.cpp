#include "control/angle_pencil.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace flextip {

AnglePencil::AnglePencil(const SmallSvd& svd, int missing_rank) noexcept
    : sigma_(svd.sigma), Q_(svd.V.transpose() * svd.U), V_(svd.V) {
  std::array<int, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](int i, int j) { return sigma_[i] < sigma_[j]; });
  for (int i = 0; i < missing_rank; ++i) sigma_[order[i]] = 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (const double sigma : sigma_) {
    if (sigma > 0.0) least = std::min(least, sigma);
  }
  smallest_x_ = 1.0 / sigma_.maxCoeff();
  largest_x_ = 1.0 / least;
  if (HasUnmoved()) largest_x_ /= std::numeric_limits<double>::epsilon();
}

PencilScale AnglePencil::Scale(double x) const noexcept {
  PencilScale scale;
  for (int i = 0; i < 3; ++i) {
    const double tangent = x * sigma_[i];
    const bool is_steep = tangent > 1.0;  // then by the cotangent: nothing overflows
    const double t = is_steep ? 1.0 / tangent : tangent;
    const double long_side = 1.0 / std::sqrt(1.0 + t * t), short_side = t * long_side;
    const double difference = (1.0 - t) * (1.0 + t) * long_side * long_side;
    scale.cosine[i] = is_steep ? short_side : long_side;
    scale.sine[i] = is_steep ? long_side : short_side;
    scale.difference[i] = is_steep ? -difference : difference;
  }
  return scale;
}

PencilPoint AnglePencil::Evaluate(double x) const noexcept {
  const PencilScale scale = Scale(x);
  Eigen::Matrix3d Z = Q_ * scale.sine.asDiagonal();
  Z.diagonal() -= scale.cosine;
  const Eigenpair largest = LargestEigenpair(Z.transpose() * Z);
  PencilPoint point;
  point.x = x;
  point.y = largest.vector;
  point.missing = largest.value;
  const Eigen::Vector3d desired = scale.cosine.cwiseProduct(point.y);
  const Eigen::Vector3d actual = Q_ * scale.sine.cwiseProduct(point.y);
  const double lengths = std::sqrt(desired.squaredNorm() * actual.squaredNorm());
  if (lengths > 0.0) point.cosine = std::clamp(desired.dot(actual) / lengths, -1.0, 1.0);
  // Rounding must not make the balance 1: y's own best x would be infinite.
  constexpr double kAlmostOne = 1.0 - 1e-15;
  point.balance = std::clamp(scale.difference.dot(point.y.cwiseAbs2()), -kAlmostOne, kAlmostOne);
  return point;
}

double AnglePencil::Balance(double x, const Eigen::Vector3d& y,
                            const Eigen::Vector3d& y_2) const noexcept {
  return Scale(x).difference.cwiseProduct(y).dot(y_2);
}

double AnglePencil::Angle(double x, const Eigen::Vector3d& y) const noexcept {
  const PencilScale scale = Scale(x);
  const Eigen::Vector3d desired = scale.cosine.cwiseProduct(y);
  const Eigen::Vector3d actual = Q_ * scale.sine.cwiseProduct(y);
  return std::atan2(desired.cross(actual).norm(), desired.dot(actual));
}

Eigen::Vector3d AnglePencil::Direction(double x, const Eigen::Vector3d& y) const noexcept {
  return (V_ * Scale(x).cosine.cwiseProduct(y)).normalized();
}

Eigen::Vector3d AnglePencil::Unmoved() const noexcept {
  int i = 0;
  sigma_.minCoeff(&i);
  return V_.col(i);
}

}  // namespace flextip
