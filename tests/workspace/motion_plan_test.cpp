// Paths that trade length against error, and following them.
#include "workspace/motion_plan.h"

#include <gtest/gtest.h>

namespace flextip {
namespace {

using Eigen::Vector2d;
const MapSetup<2> kSetup{.truth = {}, .error = {.port_m = {0.01, 0.02}}};
const Vector2d kStart(0.30, -0.23), kGoal(0.18, -0.23);

TEST(PlanMotion, IsStraightWithoutWeightAndLongerButBetterWithIt) {
  const auto map = ComputeMap(kSetup, {}, 0.005);
  const Path direct = PlanMotion(map, kStart, kGoal, {.weight = 0.0});
  const Path indirect = PlanMotion(map, kStart, kGoal, {.weight = 10.0});
  ASSERT_EQ(direct.status, PathStatus::kOk);
  ASSERT_EQ(indirect.status, PathStatus::kOk);
  EXPECT_NEAR(direct.length_m, (kGoal - kStart).norm(), 1e-6);
  EXPECT_GT(indirect.length_m, direct.length_m * 1.01);
  const auto cost = MotionCost(map, {.weight = 10.0});
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

TEST(FollowPath, KeepsToThePathWithoutErrors) {
  const std::vector<Vector2d> path{{0.3, 0.05}, {0.36, -0.08}};
  const auto followed = FollowPath<2>({.truth = {}}, path, {});
  ASSERT_EQ(followed.status, FollowStatus::kOk);
  EXPECT_LT(followed.max_deviation_m, 1e-4);  // the kinematics' curvature within a step of 0.4 mm
  EXPECT_LT((followed.tips.back() - path.back()).norm(), 1e-3);
}

/// Short moves are straight through one linear system, whose solution is an exponential.
TEST(FollowPath, StraysAsTheMeasureSays) {
  TrueShaft<2> shaft(kSetup.truth, std::nullopt);
  for (const Vector2d& start : {Vector2d(0.3, 0.0), Vector2d(0.4, 0.05), Vector2d(0.2, -0.24)}) {
    for (int i = 0; i < 8; ++i) {
      constexpr double kMove_m = 1e-4;
      const Vector2d v(std::cos(0.4 * i), std::sin(0.4 * i));
      const auto followed =
          FollowPath<2>(kSetup, {start, start + kMove_m * v},
                        {.gain = 0.002, .arrived_m = 0.02 * kMove_m, .cycles_per_move = 100000});
      ASSERT_EQ(followed.status, FollowStatus::kOk);
      const auto at = MeasureAt<2>(kSetup, shaft, start);
      const double stray = DirectionError<2>(*at.A, v, MotionFault::kStray);
      EXPECT_NEAR(followed.max_deviation_m, kMove_m * stray, 0.05 * kMove_m * stray + 1e-7);
    }
  }
}

/// A turn by an angle a: what is left of a move turns as it shrinks, e^(-t cos a), by t sin a.
TEST(DirectionError, StraysOfATurnAreASpiral) {
  const Vector2d v(1.0, 0.0);
  for (const double a : {0.2, 0.6, 1.2}) {
    const Eigen::Matrix2d A = Eigen::Rotation2Dd(a).toRotationMatrix();
    double largest = 0.0;
    for (double t = 0.0; t < 20.0; t += 1e-3)
      largest = std::max(largest, std::exp(-t * std::cos(a)) * std::abs(std::sin(t * std::sin(a))));
    EXPECT_NEAR(DirectionError<2>(A, v, MotionFault::kStray), largest, 0.05 * largest);
    EXPECT_NEAR(DirectionError<2>(A, v, MotionFault::kAngle), a, 1e-12);
    EXPECT_NEAR(DirectionError<2>(A, v, MotionFault::kNorm), 2.0 * std::sin(0.5 * a), 1e-12);
  }
  const Eigen::Matrix2d backward = -Eigen::Matrix2d::Identity();
  EXPECT_EQ(DirectionError<2>(backward, v, MotionFault::kStray), 10.0);
}

TEST(FollowPath, SaysWhereItCannotGo) {
  EXPECT_EQ(FollowPath<2>(kSetup, {{0.6, 0.0}, {0.3, 0.0}}, {}).status,
            FollowStatus::kStartOutside);
  EXPECT_EQ(FollowPath<2>(kSetup, {{0.3, 0.0}, {0.6, 0.0}}, {}).status, FollowStatus::kLost);
  EXPECT_EQ(FollowPath<2>(kSetup, {{0.3, 0.0}, {0.31, 0.01}}, {.cycles_per_move = 1}).status,
            FollowStatus::kNotArrived);
}

}  // namespace
}  // namespace flextip
