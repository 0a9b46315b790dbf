#include "calibration/camera/lens_derivative.h"

#include <algorithm>
#include <cmath>

namespace flextip {
namespace {

LensDerivative DifferentiateEquidistant(const double* k, const Eigen::Vector2d& m) {
  LensDerivative lens;
  lens.by_k.setZero();
  const double r2 = m.squaredNorm();
  if (r2 < 1e-12) {
    const double first = k[0] - 1.0 / 3.0, scale = 1.0 + first * r2;
    lens.d = scale * m;
    lens.by_m = scale * Eigen::Matrix2d::Identity() + 2.0 * first * m * m.transpose();
    lens.by_k.col(0) = r2 * m;
    return lens;
  }
  const double r = std::sqrt(r2), theta = std::atan(r), t2 = theta * theta;
  const double scale = theta * (1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])))) / r;
  const double theta_d_by_theta =
      1.0 + t2 * (3.0 * k[0] + t2 * (5.0 * k[1] + t2 * (7.0 * k[2] + t2 * 9.0 * k[3])));
  const double scale_by_r = (theta_d_by_theta / (1.0 + r2) - scale) / r;
  lens.d = scale * m;
  lens.by_m = scale * Eigen::Matrix2d::Identity() + scale_by_r / r * m * m.transpose();
  double power = theta / r;
  for (int i = 0; i < 4; ++i) lens.by_k.col(i) = (power *= t2) * m;
  return lens;
}

LensDerivative DifferentiateOpenCv(const double* coefficients, int terms,
                                   const Eigen::Vector2d& m) {
  double k[12] = {};
  std::copy_n(coefficients, terms, k);
  const double x = m.x(), y = m.y(), r2 = x * x + y * y, r4 = r2 * r2, r6 = r4 * r2;
  const double below = 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7]));
  const double f = (1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]))) / below;
  const double f_by_r2 = (k[0] + r2 * (2.0 * k[1] + 3.0 * r2 * k[4]) -
                          f * (k[5] + r2 * (2.0 * k[6] + 3.0 * r2 * k[7]))) /
                         below;
  const Eigen::Vector2d by_p1(2.0 * x * y, r2 + 2.0 * y * y), by_p2(r2 + 2.0 * x * x, 2.0 * x * y);
  const Eigen::Vector2d prism_by_r2(k[8] + 2.0 * r2 * k[9], k[10] + 2.0 * r2 * k[11]);
  LensDerivative lens;
  lens.d = f * m + k[2] * by_p1 + k[3] * by_p2 +
           Eigen::Vector2d(r2 * k[8] + r4 * k[9], r2 * k[10] + r4 * k[11]);
  const double across = 2.0 * (k[2] * x + k[3] * y);
  lens.by_m << f + 2.0 * k[2] * y + 6.0 * k[3] * x, across, across,
      f + 6.0 * k[2] * y + 2.0 * k[3] * x;
  lens.by_m += 2.0 * (f_by_r2 * m + prism_by_r2) * m.transpose();
  lens.by_k << r2 / below * m, r4 / below * m, by_p1, by_p2, r6 / below * m, -f * r2 / below * m,
      -f * r4 / below * m, -f * r6 / below * m, Eigen::Vector2d(r2, 0), Eigen::Vector2d(r4, 0),
      Eigen::Vector2d(0, r2), Eigen::Vector2d(0, r4);
  return lens;
}

}  // namespace

LensDerivative DifferentiateLens(Distortion distortion, const double* k, int terms,
                                 const Eigen::Vector2d& m) {
  return distortion == Distortion::kEquidistant ? DifferentiateEquidistant(k, m)
                                                : DifferentiateOpenCv(k, terms, m);
}

}  // namespace flextip
