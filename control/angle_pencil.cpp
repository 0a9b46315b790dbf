#include "control/angle_pencil.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace flextip {

AnglePencil::AnglePencil(const SmallSvd& svd, int missing_rank) noexcept
    : sigma_(svd.sigma), Q_(svd.V.transpose() * svd.U), V_(svd.V) {
  for (int i = 0; i < missing_rank; ++i) {
    int smallest = 0;
    for (int j = 1; j < 3; ++j) {
      if (sigma_[smallest] == 0.0 || (sigma_[j] > 0.0 && sigma_[j] < sigma_[smallest])) smallest = j;
    }
    sigma_[smallest] = 0.0;
  }
  double least = std::numeric_limits<double>::infinity();
  for (const double sigma : sigma_) {
    if (sigma > 0.0) least = std::min(least, sigma);
  }
  smallest_x_ = 1.0 / sigma_.maxCoeff();
  largest_x_ = 1.0 / least;
  if ((sigma_.array() == 0.0).any()) largest_x_ /= std::numeric_limits<double>::epsilon();
}

PencilScale AnglePencil::Scale(double x) const noexcept {
  PencilScale scale;
  for (int i = 0; i < 3; ++i) {
    const double tangent = x * sigma_[i];
    const double cosine = 1.0 / std::sqrt(1.0 + tangent * tangent);
    scale.cosine[i] = cosine;
    scale.sine[i] = tangent * cosine;
    scale.difference[i] = (1.0 - tangent) * cosine * ((1.0 + tangent) * cosine);
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
  // Rounding must not make the balance 1: y's own best x would be infinite.
  constexpr double kAlmostOne = 1.0 - 1e-15;
  point.balance =
      std::clamp(scale.difference.dot(point.y.cwiseAbs2()), -kAlmostOne, kAlmostOne);
  point.cosine = point.Least() / std::sqrt(1.0 - point.balance * point.balance);
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

}  // namespace flextip
