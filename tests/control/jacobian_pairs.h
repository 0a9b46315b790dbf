// Random pairs of a true and an estimated Jacobian, of every kind that makes the angle between
// desired and actual motion hard to find.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <random>

#include "bench/sphere_search.h"

namespace flextip {

template <int N>
struct JacobianPair {
  Eigen::Matrix<double, N, N> J;
  Eigen::Matrix<double, N, N> J_hat;
};

enum class PairKind : std::uint8_t {
  kIndependent,       ///< no relation: half of them turn some motion around
  kClose,             ///< error of 0.1 to 3 % of the entries' size
  kFarther,           ///< of 3 to 100 %
  kTruthSingular,     ///< singular values of J over six powers of ten
  kEstimateSingular,  ///< of J_hat
  kBothSingular,      ///< of both
  kNearlyTurned,      ///< nearly opposite motion all over a plane: past 90 degrees, several maxima
  kPlanar,            ///< a plane and the axis across it do not mix: crossing eigenvalues
};
inline constexpr int kPairKinds = 8;
const char* Name(PairKind kind);

/// N = 2 or 3.
template <int N>
JacobianPair<N> DrawPair(PairKind kind, std::mt19937_64& rng);

/// The pair as maps of directions w for a search: (J_hat, J) in coordinates in which no singular
/// value makes a long, narrow ridge. w stands for the motion dx_d = `H` w.
template <int N>
MotionPair<N> ForSearch(const JacobianPair<N>& pair);

}  // namespace flextip
