// A beam by its own equations (3.2), (4), what sensors would say of it, and noise on that.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <random>
#include <vector>

#include "core/draw_vector.h"
#include "core/rotation.h"
#include "kinematics/beam.h"
#include "kinematics/plane_beam.h"

namespace flextip {

struct BeamTruth {
  double L = 0.6, EI = 0.304, F = -12.0, a = 0.25;
  Eigen::Vector3d p_RW{0.1, -0.2, 0.3};
  Eigen::Matrix3d R_RM = ExpRotation({0.4, -0.9, 0.7});

  Eigen::Vector3d Tip() const { return p_RW + L * R_RM.col(0); }
  Eigen::Vector3d Direction(double x) const {
    return R_RM * Eigen::Vector3d(1.0, BeamSlope(F, a, L, x), 0.0).normalized();
  }
  /// (4), about z_M.
  Eigen::Vector3d Moment(double x) const {
    const double F_p = F * EI;
    return R_RM.col(2) * (F_p * (L - a) * x / L - F_p * std::max(0.0, x - a));
  }
};

class Noise {
 public:
  explicit Noise(unsigned seed) : rng_(seed) {}
  Eigen::Vector3d Vector(double sd) { return sd * DrawVector<3>(n_, rng_); }
  Eigen::Vector3d Turned(const Eigen::Vector3d& direction, double sd) {
    return ExpRotation(Vector(sd)) * direction;
  }

 private:
  std::mt19937 rng_;
  std::normal_distribution<double> n_;
};

/// Sample mean and covariance of (F_p/EI, a).
struct Spread {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};
inline Spread SpreadOf(const std::vector<BeamFit>& fits) {
  Spread spread;
  for (const BeamFit& fit : fits) spread.mean += Eigen::Vector2d(fit.F_p_over_EI, fit.a);
  spread.mean /= static_cast<double>(fits.size());
  for (const BeamFit& fit : fits) {
    const Eigen::Vector2d d = Eigen::Vector2d(fit.F_p_over_EI, fit.a) - spread.mean;
    spread.covariance += d * d.transpose();
  }
  spread.covariance /= static_cast<double>(fits.size() - 1);
  return spread;
}

/// Largest difference of two covariances, in units of the second one's standard deviations.
inline double CovarianceMismatch(const Eigen::Matrix2d& sample, const Eigen::Matrix2d& predicted) {
  const Eigen::Vector2d sd = predicted.diagonal().cwiseSqrt();
  return (sample - predicted).cwiseQuotient(sd * sd.transpose()).cwiseAbs().maxCoeff();
}

}  // namespace flextip
