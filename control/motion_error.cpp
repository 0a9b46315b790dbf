#include "control/motion_error.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "control/small_decompositions.h"

namespace flextip {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// a b - c d to 1.5 units in the last place (Kahan).
double Difference(double a, double b, double c, double d) {
  const double cd = c * d;
  return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

/// The map v -> p v + q conj(v) of the plane as complex numbers: every real 2 x 2 matrix is one.
/// Its singular values are |p| + |q| and ||p| - |q||.
struct ComplexMap {
  std::complex<double> p, q;

  explicit ComplexMap(const Eigen::Matrix2d& A)
      : p(0.5 * (A(0, 0) + A(1, 1)), 0.5 * (A(1, 0) - A(0, 1))),
        q(0.5 * (A(0, 0) - A(1, 1)), 0.5 * (A(1, 0) + A(0, 1))) {}
};

Eigen::Vector2d Unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// J and J_hat over their largest entries; A = J adj(J_hat) of these, each entry to rounding.
struct PlaneMap {
  double size = 0.0, size_hat = 0.0;
  double det = 0.0, det_hat = 0.0;
  bool singular = false, singular_hat = true;
  Eigen::Matrix2d A_det_hat = Eigen::Matrix2d::Zero();
};

PlaneMap Compose(const Eigen::Matrix2d& J, const Eigen::Matrix2d& J_hat) {
  PlaneMap map;
  map.size = J.cwiseAbs().maxCoeff();
  map.size_hat = J_hat.cwiseAbs().maxCoeff();
  if (map.size_hat == 0.0) return map;
  const Eigen::Matrix2d T = map.size > 0.0 ? Eigen::Matrix2d(J / map.size) : J;
  const Eigen::Matrix2d H = J_hat / map.size_hat;
  map.det = Difference(T(0, 0), T(1, 1), T(0, 1), T(1, 0));
  map.det_hat = Difference(H(0, 0), H(1, 1), H(0, 1), H(1, 0));
  // |det| over the squared norm is the ratio of the singular values, or a little less.
  map.singular = std::abs(map.det) <= 8.0 * kEpsilon * T.squaredNorm();
  map.singular_hat = std::abs(map.det_hat) <= 8.0 * kEpsilon * H.squaredNorm();
  for (int i = 0; i < 2; ++i) {
    map.A_det_hat(i, 0) = Difference(T(i, 0), H(1, 1), T(i, 1), H(1, 0));
    map.A_det_hat(i, 1) = Difference(T(i, 1), H(0, 0), T(i, 0), H(0, 1));
  }
  return map;
}

/// (2.10): the farthest that a point within `norm` of the goal can be off its direction.
double AngleBound(double norm) { return norm <= 1.0 ? std::asin(norm) : kPi; }

bool IsBad(double gain) { return !(gain > 0.0) || !std::isfinite(gain); }

}  // namespace

const char* Name(MotionErrorStatus status) {
  switch (status) {
    case MotionErrorStatus::kOk:
      return "ok";
    case MotionErrorStatus::kSingularTruth:
      return "singular_truth";
    case MotionErrorStatus::kSingularEstimate:
      return "singular_estimate";
    case MotionErrorStatus::kBadInput:
      return "bad_input";
    case MotionErrorStatus::kNotConverged:
      return "not_converged";
  }
  return "";
}

StepError<2> FindStepError(const Eigen::Matrix2d& J, const Eigen::Matrix2d& J_hat,
                           double gain) noexcept {
  StepError<2> error;
  if (!J.allFinite() || !J_hat.allFinite() || IsBad(gain)) return error;
  error.status = MotionErrorStatus::kSingularEstimate;
  const PlaneMap map = Compose(J, J_hat);
  if (map.singular_hat) return error;
  const double factor = gain * (map.size / map.size_hat) / map.det_hat;
  const Eigen::Matrix2d G = Eigen::Matrix2d::Identity() - factor * map.A_det_hat;  // (2.5)
  if (!G.allFinite()) return error;
  const ComplexMap parts(G);
  error.status = MotionErrorStatus::kOk;
  error.norm = std::abs(parts.p) + std::abs(parts.q);  // (2.6)
  // Longest where p v and q conj(v) point the same way.
  error.v_sigma = Unit(0.5 * (std::arg(parts.q) - std::arg(parts.p)));
  error.phi_hat_max_rad = AngleBound(error.norm);
  return error;
}

StepError<3> FindStepError(const Eigen::Matrix3d& J, const Eigen::Matrix3d& J_hat,
                           double gain) noexcept {
  StepError<3> error;
  if (!J.allFinite() || !J_hat.allFinite() || IsBad(gain)) return error;
  error.status = MotionErrorStatus::kSingularEstimate;
  const double size_hat = J_hat.cwiseAbs().maxCoeff();
  if (size_hat == 0.0) return error;
  const SmallSvd svd = DecomposeSmall(J_hat / size_hat);
  if (MissingRank(svd.sigma) > 0) return error;
  const Eigen::Matrix3d inverse = svd.V * svd.sigma.cwiseInverse().asDiagonal() * svd.U.transpose();
  const Eigen::Matrix3d G = Eigen::Matrix3d::Identity() - (gain / size_hat) * J * inverse;  // (2.5)
  const double scale = G.cwiseAbs().maxCoeff();
  if (!G.allFinite() || !std::isfinite(scale)) return error;
  error.status = MotionErrorStatus::kOk;
  error.norm = 0.0;
  error.phi_hat_max_rad = 0.0;
  error.v_sigma = Eigen::Vector3d::UnitX();
  if (scale == 0.0) return error;
  const Eigen::Matrix3d unit = G / scale;
  const Eigenpair largest = LargestEigenpair(unit.transpose() * unit);
  error.norm = scale * std::sqrt(largest.value);  // (2.6)
  error.v_sigma = largest.vector;
  error.phi_hat_max_rad = AngleBound(error.norm);
  return error;
}

// A v / v = p + q conj(v) / v runs around a circle about p. The largest angle is that of the
// tangent from zero, half a turn where the circle meets the negative real axis.
AngleError<2> FindLargestAngle(const Eigen::Matrix2d& J, const Eigen::Matrix2d& J_hat) noexcept {
  AngleError<2> error;
  if (!J.allFinite() || !J_hat.allFinite()) return error;
  error.status = MotionErrorStatus::kSingularEstimate;
  const PlaneMap map = Compose(J, J_hat);
  if (map.singular_hat) return error;
  error.status = map.singular ? MotionErrorStatus::kSingularTruth : MotionErrorStatus::kOk;
  if (map.size == 0.0) return error;
  const ComplexMap parts(std::copysign(1.0, map.det_hat) * map.A_det_hat);
  const double p = std::abs(parts.p), q = std::abs(parts.q);
  const double det = map.singular ? 0.0 : map.det * map.det_hat;  // |p|^2 - |q|^2
  const double turn = std::arg(parts.p);
  const double off = det < 0.0 ? kPi : std::atan2(q, std::sqrt(det));  // asin(|q| / |p|)
  double around;                                                       // arg of q conj(v) / v there
  if (std::abs(turn) + off < kPi) {
    error.phi_max_rad = std::abs(turn) + off;
    around = std::copysign(error.phi_max_rad + 0.5 * kPi, turn);
  } else {
    error.phi_max_rad = kPi;
    around = kPi - std::asin(std::clamp(-parts.p.imag() / std::max(q, kEpsilon * p), -1.0, 1.0));
  }
  error.p_phi = Unit(0.5 * (std::arg(parts.q) - around));
  return error;
}

}  // namespace flextip
