#include "simulation/sensors/em_field.h"

#include <cmath>

#include "core/linear_algebra.h"

namespace flextip::simulation {
namespace {

constexpr double kDipoleDistance_m = 0.5;
constexpr double kRadius_m = 0.1;  // where linear part and rest are compared

/// Field of a unit dipole m at r from it, in units of the field at the distance of the centre:
/// B = (3 (m.n) n - m) / |r|^3 with n = r / |r|.
Eigen::Vector3d Field(const Eigen::Vector3d& r, const Eigen::Vector3d& m) {
  const double distance = r.norm();
  const Eigen::Vector3d n = r / distance;
  return (3.0 * m.dot(n) * n - m) * std::pow(kDipoleDistance_m / distance, 3);
}

/// Its gradient, d B_i / d r_j = 3 (m_j n_i + n_j m_i + (m.n) (I - 5 n n^T)_ij) / |r|^4.
Eigen::Matrix3d FieldGradient(const Eigen::Vector3d& r, const Eigen::Vector3d& m) {
  const double distance = r.norm();
  const Eigen::Vector3d n = r / distance;
  const Eigen::Matrix3d inner = n * m.transpose() + m * n.transpose() +
                                m.dot(n) * (Eigen::Matrix3d::Identity() - 5.0 * n * n.transpose());
  return 3.0 / distance * std::pow(kDipoleDistance_m / distance, 3) * inner;
}

}  // namespace

EmField::EmField(const Eigen::Matrix3d& gradient, const Eigen::Vector3d& p_centre, double curvature)
    : gradient_(gradient), p_centre_(p_centre) {
  if (curvature == 0.0 || gradient.isZero(0.0)) return;
  const Svd svd(gradient);
  dipole_ = kDipoleDistance_m * svd.V.col(0);
  moment_ = svd.U.col(0);
  // RMS over the sphere, by points spread evenly along a spiral.
  constexpr int kPoints = 200;
  double squares = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double z = (2.0 * i + 1.0) / kPoints - 1.0, angle = 2.399963229728653 * i;
    const double r = std::sqrt(1.0 - z * z);
    squares += Rest(kRadius_m * Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z))
                   .squaredNorm();
  }
  const double linear_rms = gradient.norm() * kRadius_m / std::sqrt(3.0);
  rest_scale_ = curvature * linear_rms / std::sqrt(squares / kPoints);
}

Eigen::Vector3d EmField::Rest(const Eigen::Vector3d& offset) const {
  return Field(offset - dipole_, moment_) - Field(-dipole_, moment_) -
         FieldGradient(-dipole_, moment_) * offset;
}

Eigen::Vector3d EmField::Bias(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d offset = p - p_centre_;
  Eigen::Vector3d bias = gradient_ * offset;
  if (rest_scale_ != 0.0) bias += rest_scale_ * Rest(offset);
  return bias;
}

}  // namespace flextip::simulation
