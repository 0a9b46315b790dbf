// The correction of an EM sensor's position for a field that metal distorts.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

namespace flextip {

/// p_true = p + sum_k c_k f_k(u), u = (p - centre) / scale by component, all in R (m): `em0.field`,
/// `em0.field_centre_m` and `em0.field_scale_m` of calibration.yaml. Three coefficients (x, y, z of
/// the correction, m) for each f_k in turn. How many there are says what the f_k are:
///  9, 27, 57  the monomials of u of degree 1, 1 to 2, 1 to 3: u0, u1, u2, u0 u0, u0 u1, u0 u2,
///             u1 u1, u1 u2, u2 u2, u0 u0 u0, u0 u0 u1, ... u2 u2 u2
///  3 n^3, n = 4 to 8  products of cubic B-splines B(s0 - i) B(s1 - j) B(s2 - l), i, j, l from 0 to
///             n - 1 (l fastest), s = 1 + (n - 3) (u + 1) / 2, B on [-2, 2] with B(0) = 2/3
/// It is known where every |u| <= 1; beyond, the correction of the nearest place there is taken.
struct FieldCorrection {
  std::vector<double> coefficients = {};  ///< none: no correction
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d scale_m = Eigen::Vector3d::Ones();
};

enum class FieldKind : std::uint8_t { kNone, kPolynomial, kSpline };

/// A set of f_k: polynomials of order 1 to 3, or 4 to 8 splines a side.
struct FieldBasis {
  FieldKind kind = FieldKind::kNone;
  int order = 0;      ///< of the polynomial, or splines a side
  int Count() const;  ///< of the f_k
  Eigen::VectorXd At(const Eigen::Vector3d& u) const;
};

/// Returns the basis for that number of coefficients. Throws InputError where there is none.
FieldBasis BasisOf(std::size_t coefficients);

/// Returns the true position for a measured one (m, in R). Throws InputError as BasisOf.
Eigen::Vector3d ApplyField(const FieldCorrection& field, const Eigen::Vector3d& p);

/// Returns whether the correction is known at that position.
bool FieldCovers(const FieldCorrection& field, const Eigen::Vector3d& p);

}  // namespace flextip
