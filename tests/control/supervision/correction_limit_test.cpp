// Corrections by hand and at random.
#include "control/supervision/correction_limit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/draw_vector.h"

namespace flextip {
namespace {

const Eigen::Vector3d kZero = Eigen::Vector3d::Zero();

TEST(CorrectionLimit, KeepsWithinTheGoalsWayAndCutsTheRest) {
  std::mt19937_64 rng(3);
  std::normal_distribution<double> normal;
  int limited = 0;
  for (int trial = 0; trial < 500; ++trial) {
    Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
    for (int i = 0; i < 9; ++i) J.data()[i] += 0.3 * normal(rng);
    Eigen::Vector3d step, way;
    for (int i = 0; i < 3; ++i) step[i] = 0.001 * normal(rng);
    for (int i = 0; i < 3; ++i) way[i] = 0.0005 * normal(rng);
    const Eigen::Vector3d u = way.normalized(), p_RW(0.1, 0.2, 0.3);
    const Limited result = CorrectionLimit().Limit(p_RW, p_RW + step, J, way, {0.0008, 0.0004});
    const Eigen::Vector3d tip = J * (result.p - p_RW), wish = J * step;
    EXPECT_LT((tip - tip.dot(u) * u).norm(), 0.0008 + 1e-12);
    EXPECT_LT(std::abs(tip.dot(u)), way.norm() + 0.0004 + 1e-12);
    EXPECT_LE((result.p - p_RW).norm(), step.norm() * (1.0 + 1e-12));
    limited += result.limited;
    const bool is_within =
        (wish - wish.dot(u) * u).norm() <= 0.0008 && std::abs(wish.dot(u)) <= way.norm() + 0.0004;
    EXPECT_EQ(result.limited, !is_within);
    if (is_within) EXPECT_EQ(result.p, p_RW + step);
  }
  EXPECT_GT(limited, 100);
  EXPECT_LT(limited, 400);
}

TEST(CorrectionLimit, CutsEveryDirectionWhereTheGoalStandsAndNothingWithoutAJacobian) {
  const Eigen::Matrix3d J = 2.0 * Eigen::Matrix3d::Identity();
  const Limited cut =
      CorrectionLimit(30.0).Limit(kZero, {0.003, 0.0, 0.004}, J, kZero, {0.001, 0.0});
  EXPECT_TRUE(cut.limited);
  EXPECT_LT((cut.p - Eigen::Vector3d(0.0003, 0.0, 0.0004)).norm(), 1e-15);
  const Eigen::Matrix3d none = Eigen::Matrix3d::Constant(std::nan(""));
  EXPECT_FALSE(
      CorrectionLimit(30.0).Limit(kZero, {0.003, 0.0, 0.004}, none, kZero, {0.001, 0.0}).limited);
  EXPECT_FALSE(
      CorrectionLimit(30.0).Limit(kZero, {0.003, 0, 0}, 0.0 * J, kZero, {0.001, 0.0}).limited);
}

TEST(CorrectionLimit, FastCyclesTogetherMoveTheTipAsOnePictureMay) {
  const Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
  const CorrectionLimits limits{0.0008, 0.0004};
  for (const double rate_hz : {30.0, 120.0, 1000.0}) {
    CorrectionLimit limit(rate_hz);
    const int cycles = int(rate_hz / 30.0);
    double went_m = 0.0;
    for (int i = 0; i < cycles; ++i) {
      const Limited one = limit.Limit(kZero, {0.0, 0.001, 0.0}, J, kZero, limits);
      went_m += one.p.y();
    }
    // What was corrected is forgotten over a picture's time.
    EXPECT_GT(went_m, 0.00079) << rate_hz;
    EXPECT_LT(went_m, 0.0008 * 2.0) << rate_hz;
  }
}

TEST(CorrectionLimit, NoiseOfFastCyclesIsNotLimited) {
  // The tip follows each sample, so that a correction takes the last one back.
  std::mt19937_64 rng(4);
  std::normal_distribution<double> normal(0.0, 0.0001);
  CorrectionLimit limit(1000.0), one;
  const Eigen::Vector3d way(1.5e-5, 0.0, 0.0);
  Eigen::Vector3d last = kZero;
  int limited = 0, by_each = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d sample = DrawVector<3>(normal, rng), p_wish = way + sample - last;
    const Eigen::Matrix3d J = Eigen::Matrix3d::Identity();
    limited += limit.Limit(kZero, p_wish, J, way, {0.0008, 0.0004}).limited;
    by_each += one.Limit(kZero, p_wish, J, way, {0.000024, 0.000012}).limited;
    last = sample;
  }
  // A thirtieth of the limit for each cycle would cut nearly all.
  EXPECT_GT(by_each, 2900);
  EXPECT_LT(10 * limited, by_each);
}

}  // namespace
}  // namespace flextip
