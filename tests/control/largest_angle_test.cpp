// The largest angle against a search of all directions, 10,000 pairs in the plane and in space
// (a tenth under the address sanitizer).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "cell_search.h"
#include "control/motion_error.h"
#include "jacobian_pairs.h"
#include "tests/repetitions.h"

namespace flextip {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kPairsPerKind = 1250;  // of 8 kinds
constexpr double kAgreement_rad = 1e-9;
constexpr double kProof_rad = 5e-10;  // what the cells leave open

/// A dense grid's maxima refined, then all cells that might hold more: several maxima, or one much
/// narrower than the grid, cannot be missed.
template <int N>
double SearchAll(const MotionPair<N>& pair) {
  constexpr int kGrid = 24;
  std::vector<double> grid;
  const SphereMaximum<N> start = SearchSphere(pair, kGrid, grid);
  const CellSearchResult proof = SearchCells(pair, start.angle, kProof_rad);
  EXPECT_TRUE(proof.decided);
  return proof.angle;
}

/// The angle of the direction that is said to be the worst. Its own rounding, 1e-16, is magnified
/// by A's condition.
template <int N>
void ExpectAttained(const JacobianPair<N>& pair, const AngleError<N>& error) {
  using Long = Eigen::Matrix<long double, N, N>;
  const Long A =
      pair.J.template cast<long double>() * pair.J_hat.template cast<long double>().inverse();
  MotionPair<N> map;
  map.T = A.template cast<double>();
  const double condition = map.T.norm() * map.T.inverse().norm();
  EXPECT_NEAR(map.Angle(error.p_phi), error.phi_max_rad, kAgreement_rad + 2e-15 * condition);
  EXPECT_NEAR(error.p_phi.norm(), 1.0, 1e-14);
}

template <int N>
void CompareWithSearch(PairKind kind) {
  constexpr int kPairs = Repetitions(kPairsPerKind);
  std::mt19937_64 rng(100 + static_cast<unsigned>(kind));
  double worst = 0.0;
  int past = 0;
  for (int i = 0; i < kPairs; ++i) {
    const JacobianPair<N> pair = DrawPair<N>(kind, rng);
    const AngleError<N> error = FindLargestAngle(pair.J, pair.J_hat);
    ASSERT_EQ(error.status, MotionErrorStatus::kOk) << i;
    const double difference = error.phi_max_rad - SearchAll(ForSearch(pair));
    ASSERT_LT(std::abs(difference), kAgreement_rad) << i << ", " << error.phi_max_rad;
    ExpectAttained(pair, error);
    worst = std::max(worst, std::abs(difference));
    if (error.phi_max_rad > kPi / 2) ++past;
  }
  ::testing::Test::RecordProperty("worst_1e15_rad", std::to_string(worst * 1e15));
  ::testing::Test::RecordProperty("past_90_degrees", past);
  if (kind == PairKind::kIndependent || kind == PairKind::kNearlyTurned) {
    EXPECT_GT(past, kPairs / 2);
  }
}

class LargestAnglePairs : public ::testing::TestWithParam<int> {};

TEST_P(LargestAnglePairs, AgreesWithTheCircle) {
  CompareWithSearch<2>(static_cast<PairKind>(GetParam()));
}

TEST_P(LargestAnglePairs, AgreesWithTheSphere) {
  CompareWithSearch<3>(static_cast<PairKind>(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Kinds, LargestAnglePairs, ::testing::Range(0, kPairKinds),
                         [](const auto& kind) {
                           return std::string(Name(static_cast<PairKind>(kind.param)));
                         });

/// The search that the others are held against must itself find what is hidden: a needle between
/// the grid's directions, from a start that knows nothing.
TEST(CellSearch, FindsANeedle) {
  MotionPair<3> pair;
  // Moves as desired but for directions within about 1e-5 of (1, 2, 3), which are turned around.
  const Eigen::Vector3d n = Eigen::Vector3d(1, 2, 3).normalized();
  pair.T = Eigen::Matrix3d::Identity() - (1.0 + 1e-5) * n * n.transpose();
  const CellSearchResult found = SearchCells(pair, 0.0, kProof_rad);
  EXPECT_TRUE(found.decided);
  EXPECT_NEAR(found.angle, kPi, kProof_rad);
  EXPECT_NEAR(FindLargestAngle(pair.T, pair.H).phi_max_rad, kPi, kProof_rad);
}

TEST(CellSearch, DoesNotTakeLessForTheMost) {
  // A map with a known answer: the largest angle of a stretch by 1 to 3 is asin(1/2).
  MotionPair<3> pair;
  pair.T = Eigen::Vector3d(1.0, 2.0, 3.0).asDiagonal();
  const CellSearchResult found = SearchCells(pair, 0.1, kProof_rad);
  EXPECT_TRUE(found.raised);
  EXPECT_NEAR(found.angle, kPi / 6, kProof_rad);
}

}  // namespace
}  // namespace flextip
