// Paths that trade length against error, and following them.
#include "workspace/motion_plan.h"

#include <gtest/gtest.h>

namespace flextip {
namespace {

using Eigen::Vector2d;
const MapSetup<2> kSetup{.truth = {}, .error = {.port_m = {0.01, 0.02}}};
const Vector2d kStart(0.22, 0.05), kGoal(0.22, -0.09);

TEST(PlanMotion, IsStraightWithoutWeightAndLongerButBetterWithIt) {
  const auto map = ComputeMap(kSetup, {}, 0.005);
  const Path direct = PlanMotion(map, kStart, kGoal, {.weight = 0.0});
  const Path indirect = PlanMotion(map, kStart, kGoal, {.weight = 4.0});
  ASSERT_EQ(direct.status, PathStatus::kOk);
  ASSERT_EQ(indirect.status, PathStatus::kOk);
  EXPECT_NEAR(direct.length_m, (kGoal - kStart).norm(), 1e-6);
  EXPECT_GT(indirect.length_m, direct.length_m * 1.01);
  const auto cost = MotionCost(map, {.weight = 4.0});
  EXPECT_LT(indirect.cost, CostAlong(cost, direct.points, 0.005));
  const auto by_direct = FollowPath<2>(kSetup, direct.points, {});
  const auto by_indirect = FollowPath<2>(kSetup, indirect.points, {});
  ASSERT_EQ(by_direct.status, FollowStatus::kOk);
  ASSERT_EQ(by_indirect.status, FollowStatus::kOk);
  EXPECT_LT(by_indirect.max_deviation_m, by_direct.max_deviation_m);
}

TEST(MotionCost, IsInfiniteOffTheWorkspaceAndExactOnTheGrid) {
  const auto map = ComputeMap(kSetup, {}, 0.01);
  const auto cost = MotionCost(map, {.fault = MotionFault::kNorm, .weight = 2.0});
  EXPECT_FALSE(std::isfinite(cost({0.16, 0.05}, Vector2d::UnitX())));
  EXPECT_FALSE(std::isfinite(cost({5.0, 5.0}, Vector2d::UnitX())));
  for (const auto& at : map.points) {
    if (!at.A) continue;
    EXPECT_NEAR(cost(at.p_tip, at.step.v_sigma), 1.0 + 2.0 * at.step.norm,
                1e-6 * (1.0 + at.step.norm));
  }
}

TEST(FollowPath, KeepsToThePathWithoutErrorsAndFinerSteps) {
  const std::vector<Vector2d> path{{0.3, 0.05}, {0.36, -0.02}, {0.32, -0.08}};
  const MapSetup<2> exact{.truth = {}};
  const auto coarse = FollowPath<2>(exact, path, {.step_m = 0.004});
  const auto fine = FollowPath<2>(exact, path, {.step_m = 0.001});
  ASSERT_EQ(fine.status, FollowStatus::kOk);
  // What is left is the curvature of the kinematics: of second order in the step.
  EXPECT_LT(fine.max_deviation_m, 2e-5);
  EXPECT_NEAR(coarse.max_deviation_m / fine.max_deviation_m, 16.0, 6.0);
  EXPECT_LT((fine.tips.back() - path.back()).norm(), 1e-4);
}

/// With the steps small, the lag settles where the gain's step makes up for the desired position's:
/// the deviation is the part of G (I - G)^-1 v that is square to the path.
TEST(FollowPath, DeviatesAsTheMeasuresSay) {
  const Vector2d start(0.3, 0.0), goal(0.302, 0.002), v = (goal - start).normalized();
  constexpr double kStep = 1e-5;
  const auto followed = FollowPath<2>(kSetup, {start, goal}, {.step_m = kStep});
  ASSERT_EQ(followed.status, FollowStatus::kOk);
  TrueShaft<2> shaft(kSetup.truth, std::nullopt);
  const auto at = MeasureAt(kSetup, shaft, goal);
  const Eigen::Matrix2d G = Eigen::Matrix2d::Identity() - *at.A;
  const Vector2d lag = (Eigen::Matrix2d::Identity() - G).inverse() * G * v;
  const double expected = kStep * std::abs(v.x() * lag.y() - v.y() * lag.x());
  EXPECT_NEAR(followed.max_deviation_m, expected, 0.05 * expected);
}

TEST(FollowPath, SaysWhereItCannotGo) {
  EXPECT_EQ(FollowPath<2>(kSetup, {{0.6, 0.0}, {0.3, 0.0}}, {}).status,
            FollowStatus::kStartOutside);
  EXPECT_EQ(FollowPath<2>(kSetup, {{0.3, 0.0}, {0.6, 0.0}}, {}).status, FollowStatus::kLost);
  EXPECT_EQ(FollowPath<2>(kSetup, {{0.3, 0.0}, {0.31, 0.01}}, {.settle_cycles = 0}).status,
            FollowStatus::kNotArrived);
}

}  // namespace
}  // namespace flextip
