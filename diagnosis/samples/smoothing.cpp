#include "diagnosis/samples/smoothing.h"

#include <cmath>

namespace flextip::diagnosis {
namespace {

constexpr int kMaxHalfWidth = 4, kMinHalfWidth = 2;

struct LocalFit {
  Eigen::Vector3d p;
  double noise_factor = 1.0;  ///< of the fitted value against one sample
  double chi2_per_dof = 0.0;
};

/// Least-squares quadratic through samples k - half .. k + half, at k.
LocalFit FitAround(const std::vector<double>& t_s, const std::vector<Eigen::Vector3d>& p, int k,
                   int half, double noise) {
  Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d rhs = Eigen::Matrix3d::Zero();
  const double span = t_s[k + half] - t_s[k - half];
  const auto basis = [&](int i) {
    const double u = (t_s[i] - t_s[k]) / span;
    return Eigen::Vector3d(1.0, u, u * u);
  };
  for (int i = k - half; i <= k + half; ++i) {
    N += basis(i) * basis(i).transpose();
    rhs += basis(i) * p[i].transpose();
  }
  const Eigen::Matrix3d inverse = N.inverse();
  const Eigen::Matrix3d coefficients = inverse * rhs;
  double sum = 0.0;
  for (int i = k - half; i <= k + half; ++i)
    sum += (coefficients.transpose() * basis(i) - p[i]).squaredNorm();
  const double dof = 3.0 * (2 * half + 1 - 3);
  return {coefficients.row(0).transpose(), std::sqrt(inverse(0, 0)), sum / (dof * noise * noise)};
}

}  // namespace

Smoothed Smooth(const std::vector<double>& t_s, const std::vector<Eigen::Vector3d>& value,
                double noise) {
  Smoothed smoothed{value, std::vector<double>(value.size(), noise)};
  if (noise <= 0.0) return smoothed;
  const int n = int(value.size());
  for (int k = 0; k < n; ++k) {
    for (int half = kMaxHalfWidth; half >= kMinHalfWidth; --half) {
      if (k - half < 0 || k + half >= n) continue;
      const LocalFit fit = FitAround(t_s, value, k, half, noise);
      const double dof = 3.0 * (2 * half + 1 - 3);
      if (fit.chi2_per_dof > 1.0 + 3.0 * std::sqrt(2.0 / dof)) continue;
      smoothed.value[k] = fit.p;
      smoothed.noise[k] = noise * fit.noise_factor;
      break;
    }
  }
  return smoothed;
}

}  // namespace flextip::diagnosis
