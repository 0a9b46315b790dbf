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
