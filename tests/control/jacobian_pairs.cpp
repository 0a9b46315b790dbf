#include "jacobian_pairs.h"

#include <array>
#include <cmath>

#include "core/linear_algebra.h"

namespace flextip {
namespace {

template <int N>
using Square = Eigen::Matrix<double, N, N>;

double Uniform(std::mt19937_64& rng) { return std::uniform_real_distribution<double>()(rng); }

template <int N>
Square<N> Normal(std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  return Square<N>::NullaryExpr([&] { return normal(rng); });
}

template <int N>
Square<N> Turned(std::mt19937_64& rng) {
  return Eigen::HouseholderQR<Square<N>>(Normal<N>(rng)).householderQ();
}

/// Singular values over so many powers of ten.
template <int N>
Square<N> Spread(double powers, std::mt19937_64& rng) {
  Eigen::Matrix<double, N, 1> sigma;
  for (double& value : sigma) value = std::pow(10.0, -powers * Uniform(rng));
  const Square<N> U = Turned<N>(rng);
  return U * sigma.asDiagonal() * Turned<N>(rng);
}

/// A with eigenvalues -1 +- i b, and in space a positive one.
template <int N>
Square<N> NearlyOpposite(std::mt19937_64& rng) {
  const double b = std::pow(10.0, -Uniform(rng));
  Square<N> D = Square<N>::Zero();
  D.template topLeftCorner<2, 2>() << -1.0, b, -b, -1.0;
  if constexpr (N == 3) D(2, 2) = std::pow(10.0, 2.0 * Uniform(rng) - 1.0);
  const Square<N> B = Spread<N>(1.0, rng);
  return B * D * B.inverse();
}

/// A plane's map and a factor across it; the identity of N = 2 is all plane.
template <int N>
Square<N> Planar(std::mt19937_64& rng) {
  Square<N> M = Normal<N>(rng);
  if constexpr (N == 3) M(0, 2) = M(1, 2) = M(2, 0) = M(2, 1) = 0.0;
  return M;
}

}  // namespace

const char* Name(PairKind kind) {
  static constexpr std::array<const char*, kPairKinds> kNames{
      "Independent",      "Close",        "Farther",      "TruthSingular",
      "EstimateSingular", "BothSingular", "NearlyTurned", "Planar"};
  return kNames[static_cast<std::size_t>(kind)];
}

template <int N>
JacobianPair<N> DrawPair(PairKind kind, std::mt19937_64& rng) {
  JacobianPair<N> pair{Normal<N>(rng), Normal<N>(rng)};
  switch (kind) {
    case PairKind::kIndependent:
      break;
    case PairKind::kClose:
      pair.J_hat = pair.J + std::pow(10.0, -3.0 + 1.5 * Uniform(rng)) * pair.J_hat;
      break;
    case PairKind::kFarther:
      pair.J_hat = pair.J + std::pow(10.0, -1.5 + 1.5 * Uniform(rng)) * pair.J_hat;
      break;
    case PairKind::kTruthSingular:
      pair.J = Spread<N>(6.0, rng);
      break;
    case PairKind::kEstimateSingular:
      pair.J_hat = Spread<N>(6.0, rng);
      break;
    case PairKind::kBothSingular:
      pair = {Spread<N>(6.0, rng), Spread<N>(6.0, rng)};
      break;
    case PairKind::kNearlyTurned:
      pair.J = NearlyOpposite<N>(rng) * pair.J_hat;
      break;
    case PairKind::kPlanar: {
      const Square<N> U = Turned<N>(rng), plane = Planar<N>(rng);
      pair.J = U * plane * U.transpose();
      pair.J_hat = U * (plane + 0.3 * Planar<N>(rng)) * U.transpose();
      break;
    }
  }
  return pair;
}

// With A = U diag(sigma) V^T, w = J_hat^-1 V D z and D = diag(sigma_2 / sigma_1, 1, 1): both maps
// of z are then small at single directions only, not along a circle. Products in long double keep
// what the nearly singular Jacobians leave of the digits.
template <int N>
MotionPair<N> ForSearch(const JacobianPair<N>& pair) {
  using Long = Eigen::Matrix<long double, N, N>;
  const Long J = pair.J.template cast<long double>();
  const Long J_hat = pair.J_hat.template cast<long double>();
  const Long inverse = J_hat.inverse();
  const Square<N> A = (J * inverse).template cast<double>();
  const Svd<N> svd(A);
  Eigen::Matrix<double, N, 1> D = Eigen::Matrix<double, N, 1>::Ones();
  if constexpr (N == 3) D[0] = svd.sigma[1] / svd.sigma[0];
  const Square<N> VD = svd.V * D.asDiagonal();
  const Long P = (inverse * VD.template cast<long double>())
                     .template cast<double>()
                     .template cast<long double>();
  return {(J_hat * P).template cast<double>(), (J * P).template cast<double>()};
}

template JacobianPair<2> DrawPair<2>(PairKind, std::mt19937_64&);
template JacobianPair<3> DrawPair<3>(PairKind, std::mt19937_64&);
template MotionPair<2> ForSearch<2>(const JacobianPair<2>&);
template MotionPair<3> ForSearch<3>(const JacobianPair<3>&);

}  // namespace flextip
