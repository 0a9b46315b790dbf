// Each limit by itself, against motions counted by hand.
#include "control/supervision/rate_limits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace flextip {
namespace {

const Eigen::Vector3d kZero = Eigen::Vector3d::Zero();

TEST(LimitStep, CutsTheLengthAndKeepsTheDirection) {
  EXPECT_FALSE(LimitStep({1, 0, 0}, {1.001, 0, 0}, 0.002).limited);
  const Limited cut = LimitStep({1, 0, 0}, {1.003, 0.004, 0}, 0.002);
  EXPECT_TRUE(cut.limited);
  EXPECT_LT((cut.p - Eigen::Vector3d(1.0012, 0.0016, 0)).norm(), 1e-15);
}

TEST(LimitSpeed, IsAStepOfTheTime) {
  const Limited cut = LimitSpeed(kZero, {0, 0.01, 0}, 0.01, 0.05);
  EXPECT_TRUE(cut.limited);
  EXPECT_NEAR(cut.p.y(), 0.0005, 1e-18);
  EXPECT_FALSE(LimitSpeed(kZero, {0, 0.0004, 0}, 0.01, 0.05).limited);
}

TEST(LimitCorrection, KeepsWithinTheGoalsWayAndCutsTheRest) {
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
    const Limited result = LimitCorrection(p_RW, p_RW + step, J, way, {0.0008, 0.0004});
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

TEST(LimitCorrection, CutsEveryDirectionWhereTheGoalStandsAndNothingWithoutAJacobian) {
  const Eigen::Matrix3d J = 2.0 * Eigen::Matrix3d::Identity();
  const Limited cut = LimitCorrection(kZero, {0.003, 0.0, 0.004}, J, kZero, {0.001, 0.0});
  EXPECT_TRUE(cut.limited);
  EXPECT_LT((cut.p - Eigen::Vector3d(0.0003, 0.0, 0.0004)).norm(), 1e-15);
  const Eigen::Matrix3d none = Eigen::Matrix3d::Constant(std::nan(""));
  EXPECT_FALSE(LimitCorrection(kZero, {0.003, 0.0, 0.004}, none, kZero, {0.001, 0.0}).limited);
  EXPECT_FALSE(LimitCorrection(kZero, {0.003, 0, 0}, 0.0 * J, kZero, {0.001, 0.0}).limited);
}

TEST(LimitAcceleration, ReachesAPlaceWithoutOvershootAndWithoutMoreThanItsBound) {
  std::mt19937_64 rng(5);
  std::normal_distribution<double> normal(0.0, 0.01);
  for (int trial = 0; trial < 50; ++trial) {
    const double dt_s = trial % 2 == 0 ? 0.001 : 1.0 / 120.0, most = 1.0;
    Eigen::Vector3d goal;
    for (int i = 0; i < 3; ++i) goal[i] = normal(rng);
    Eigen::Vector3d p = kZero, v = kZero;
    double farthest = 0.0;
    for (int i = 0; i < 2000; ++i) {
      const Limited next = LimitAcceleration(p, v, goal, dt_s, most);
      const Eigen::Vector3d v_next = (next.p - p) / dt_s;
      EXPECT_LE((v_next - v).norm(), most * dt_s * (1.0 + 1e-6));
      p = next.p;
      v = v_next;
      farthest = std::max(farthest, p.dot(goal.normalized()));
    }
    EXPECT_LT((p - goal).norm(), 1e-9);
    EXPECT_LT(farthest, goal.norm() + 1e-9);
  }
}

TEST(LimitAcceleration, SaysWhetherItLimited) {
  EXPECT_TRUE(LimitAcceleration(kZero, kZero, {0.001, 0, 0}, 0.01, 1.0).limited);
  EXPECT_FALSE(LimitAcceleration(kZero, kZero, {0.00005, 0, 0}, 0.01, 1.0).limited);
}

TEST(KeepInBox, TakesTheNearestPlace) {
  const WorkspaceBox box{{-1, -1, -1}, {1, 1, 1}};
  EXPECT_FALSE(KeepInBox(box, {0.5, 0, 1.0}).limited);
  const Limited kept = KeepInBox(box, {2, 0.5, -3});
  EXPECT_TRUE(kept.limited);
  EXPECT_EQ(kept.p, Eigen::Vector3d(1, 0.5, -1));
}

}  // namespace
}  // namespace flextip
