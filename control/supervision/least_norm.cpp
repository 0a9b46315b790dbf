#include "control/supervision/least_norm.h"

#include "core/linear_algebra.h"

namespace flextip {
namespace {

constexpr int kHalvings = 100;
constexpr double kLeastVariance = 1e-12;  // of the largest: an axis without doubt

}  // namespace

double LeastNorm(const Eigen::Vector3d& mean, const Eigen::Matrix3d& covariance,
                 double deviations) {
  if (!mean.allFinite() || !covariance.allFinite()) return 0.0;
  const SymmetricEigen<3> axes(covariance);
  const double largest = axes.values.maxCoeff();
  if (!(largest > 0.0)) return mean.norm();
  const Eigen::Array3d variance = axes.values.array().max(kLeastVariance * largest);
  const Eigen::Array3d f = (axes.vectors.transpose() * mean).array();
  const double k2 = deviations * deviations;
  if ((f * f / variance).sum() <= k2) return 0.0;
  // The nearest place to zero on the ellipsoid is f / (1 + m variance) along its axes, for the
  // multiplier m at which that lies on the surface; its distance from the mean grows with m.
  const auto deviations2 = [&](double m) {
    return (f * f * m * m * variance / (1.0 + m * variance).square()).sum();
  };
  double low = 0.0, high = 1.0 / largest;
  for (int i = 0; i < kHalvings && deviations2(high) < k2; ++i) high *= 2.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (deviations2(middle) < k2 ? low : high) = middle;
  }
  return (f / (1.0 + low * variance)).matrix().norm();
}

}  // namespace flextip
