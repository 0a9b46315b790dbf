#include "recording/calibrations/em_field.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"

namespace flextip {
namespace {

constexpr int kFewestSplines = 4, kMostSplines = 8, kHighestOrder = 3;

/// The cubic B-spline on [-2, 2].
double Spline(double s) {
  const double a = std::abs(s);
  if (a >= 2.0) return 0.0;
  if (a >= 1.0) return std::pow(2.0 - a, 3) / 6.0;
  return 2.0 / 3.0 - a * a + 0.5 * a * a * a;
}

Eigen::VectorXd Monomials(int order, int count, const Eigen::Vector3d& u) {
  Eigen::VectorXd f(count);
  int k = 0;
  for (int i = 0; i < 3; ++i) f[k++] = u[i];
  for (int i = 0; i < 3 && order >= 2; ++i) {
    for (int j = i; j < 3; ++j) f[k++] = u[i] * u[j];
  }
  for (int i = 0; i < 3 && order >= 3; ++i) {
    for (int j = i; j < 3; ++j) {
      for (int l = j; l < 3; ++l) f[k++] = u[i] * u[j] * u[l];
    }
  }
  return f;
}

Eigen::VectorXd Splines(int n, const Eigen::Vector3d& u) {
  Eigen::Matrix3Xd B(3, n);
  for (int axis = 0; axis < 3; ++axis) {
    const double s = 0.5 * (u[axis] + 1.0) * (n - 3) + 1.0;
    for (int i = 0; i < n; ++i) B(axis, i) = Spline(s - i);
  }
  Eigen::VectorXd f(n * n * n);
  int k = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      for (int l = 0; l < n; ++l) f[k++] = B(0, i) * B(1, j) * B(2, l);
    }
  }
  return f;
}

Eigen::Vector3d Scaled(const FieldCorrection& field, const Eigen::Vector3d& p) {
  return (p - field.centre_m).cwiseQuotient(field.scale_m);
}

}  // namespace

int FieldBasis::Count() const {
  if (kind == FieldKind::kNone) return 0;
  if (kind == FieldKind::kSpline) return order * order * order;
  return (order + 1) * (order + 2) * (order + 3) / 6 - 1;
}

Eigen::VectorXd FieldBasis::At(const Eigen::Vector3d& u) const {
  if (kind == FieldKind::kNone) return {};
  return kind == FieldKind::kSpline ? Splines(order, u) : Monomials(order, Count(), u);
}

FieldBasis BasisOf(std::size_t coefficients) {
  if (coefficients == 0) return {};
  for (int order = 1; order <= kHighestOrder; ++order) {
    const FieldBasis basis{FieldKind::kPolynomial, order};
    if (coefficients == 3U * basis.Count()) return basis;
  }
  for (int n = kFewestSplines; n <= kMostSplines; ++n) {
    const FieldBasis basis{FieldKind::kSpline, n};
    if (coefficients == 3U * basis.Count()) return basis;
  }
  throw InputError(fmt::format(
      "em0.field: found {} coefficients, expected 9, 27, 57 or 3 n^3 with n from 4 to 8",
      coefficients));
}

Eigen::Vector3d ApplyField(const FieldCorrection& field, const Eigen::Vector3d& p) {
  const FieldBasis basis = BasisOf(field.coefficients.size());
  if (basis.kind == FieldKind::kNone) return p;
  const Eigen::Vector3d u = Scaled(field, p).cwiseMax(-1.0).cwiseMin(1.0);
  const Eigen::Map<const Eigen::Matrix3Xd> c(field.coefficients.data(), 3, basis.Count());
  return p + c * basis.At(u);
}

bool FieldCovers(const FieldCorrection& field, const Eigen::Vector3d& p) {
  return field.coefficients.empty() || (Scaled(field, p).cwiseAbs().array() <= 1.0).all();
}

}  // namespace flextip
