#include "control/angle_level.h"

#include <algorithm>

namespace flextip {
namespace {

/// Product of two polynomials, lowest power first.
template <std::size_t M, std::size_t N>
std::array<double, M + N - 1> Times(const std::array<double, M>& p,
                                    const std::array<double, N>& q) {
  std::array<double, M + N - 1> product{};
  for (std::size_t i = 0; i < M; ++i) {
    for (std::size_t j = 0; j < N; ++j) product[i + j] += p[i] * q[j];
  }
  return product;
}

/// p(1 + z) from p(x).
void Shift(std::array<double, 7>& p) {
  for (int first = 0; first < 6; ++first) {
    for (int k = 5; k >= first; --k) p[k] += p[k + 1];
  }
}

/// p(scale x) from p(x).
void Stretch(std::array<double, 7>& p, double scale) {
  double power = 1.0;
  for (double& coefficient : p) {
    coefficient *= power;
    power *= scale;
  }
}

}  // namespace

AngleLevel::AngleLevel(const AnglePencil& pencil, double c) noexcept {
  const Eigen::Vector3d& sigma = pencil.Sigma();
  const Eigen::Matrix3d Q_sigma = pencil.Q() * sigma.asDiagonal();
  const Eigen::Matrix3d twice_S = Q_sigma + Q_sigma.transpose();  // A + A^T
  std::array<std::array<double, 3>, 3> diagonal{};
  for (int i = 0; i < 3; ++i) diagonal[i] = {c, twice_S(i, i), c * sigma[i] * sigma[i]};
  coefficients_ = Times(Times(diagonal[0], diagonal[1]), diagonal[2]);
  coefficients_[3] += 2.0 * twice_S(0, 1) * twice_S(0, 2) * twice_S(1, 2);
  for (int i = 0; i < 3; ++i) {
    const double off = twice_S((i + 1) % 3, (i + 2) % 3);
    for (int k = 0; k < 3; ++k) coefficients_[k + 2] -= diagonal[i][k] * off * off;
  }
}

double AngleLevel::Value(double x) const noexcept {
  double value = 0.0;
  for (int k = 6; k >= 0; --k) value = value * x + coefficients_[k];
  return value;
}

bool AngleLevel::IsPositive(double a, double b) const noexcept {
  // x = a (1 + (b / a - 1) / (1 + z)) maps z > 0 to the interval, end to beginning: without a
  // change of sign among its coefficients the polynomial in z has no root there.
  std::array<double, 7> p = coefficients_;
  Stretch(p, a);
  Shift(p);
  Stretch(p, b / a - 1.0);
  std::reverse(p.begin(), p.end());
  Shift(p);
  return std::all_of(p.begin(), p.end(), [](double coefficient) { return coefficient > 0.0; });
}

}  // namespace flextip
