// Cheapest paths that are known exactly.
#include "workspace/path_planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace flextip {
namespace {

using Eigen::Vector2d;
constexpr double kInf = std::numeric_limits<double>::infinity();

PathProblem Problem(const Vector2d& start, const Vector2d& goal, double spacing) {
  return {.start = start, .goal = goal, .low = {-1, -1}, .high = {1, 1}, .spacing_m = spacing};
}

TEST(PathPlanner, GoesStraightWhereAllIsAlike) {
  const auto one = [](const Vector2d&, const Vector2d&) { return 1.0; };
  const Vector2d start(-0.713, 0.2), goal(0.61, -0.4437);
  const Path path = PlanPath(one, Problem(start, goal, 0.05));
  ASSERT_EQ(path.status, PathStatus::kOk);
  EXPECT_EQ(path.points.front(), start);
  EXPECT_EQ(path.points.back(), goal);
  EXPECT_NEAR(path.length_m, (goal - start).norm(), 1e-6);
  EXPECT_NEAR(path.cost, path.length_m, 1e-12);
}

TEST(PathPlanner, GoesStraightWhereOnlyTheDirectionMatters) {
  const Eigen::Matrix2d M = (Eigen::Matrix2d() << 2.0, 0.9, 0.9, 1.0).finished();
  const auto cost = [&](const Vector2d&, const Vector2d& v) { return std::sqrt(v.dot(M * v)); };
  const Vector2d start(-0.7, 0.2), goal(0.6, -0.4), d = goal - start;
  const Path path = PlanPath(cost, Problem(start, goal, 0.05));
  EXPECT_NEAR(path.cost, std::sqrt(d.dot(M * d)), 1e-4);
}

/// The hyperbolic plane: a metre costs 1 / height. Its straight lines are circles about y = -1.2,
/// with a known length.
TEST(PathPlanner, FindsTheCircleOfTheHyperbolicPlane) {
  const auto height = [](const Vector2d& p) { return p.y() + 1.2; };
  const auto cost = [&](const Vector2d& p, const Vector2d&) { return 1.0 / height(p); };
  const Vector2d start(-0.6, -0.8), goal(0.6, -0.7);
  const Path path = PlanPath(cost, Problem(start, goal, 0.04));
  const double exact =
      std::acosh(1.0 + (goal - start).squaredNorm() / (2.0 * height(start) * height(goal)));
  EXPECT_NEAR(path.cost, exact, 2e-3 * exact);
  EXPECT_GT(path.cost, exact * (1.0 - 1e-4));  // nothing is cheaper
  // Through both, centre at y = -1.2: its x from equal distances.
  const double x = (goal.squaredNorm() + 2.4 * goal.y() - start.squaredNorm() - 2.4 * start.y()) /
                   (2.0 * (goal.x() - start.x()));
  const Vector2d centre(x, -1.2);
  for (const auto& p : path.points) EXPECT_NEAR((p - centre).norm(), (start - centre).norm(), 0.02);
}

TEST(PathPlanner, GoesAroundADisc) {
  constexpr double kRadius = 0.3;
  const auto cost = [](const Vector2d& p, const Vector2d&) {
    return p.norm() < kRadius ? kInf : 1.0;
  };
  const Vector2d start(-0.8, 0.01), goal(0.8, 0.01);
  const Path path = PlanPath(cost, Problem(start, goal, 0.02));
  ASSERT_EQ(path.status, PathStatus::kOk);
  // Two tangents and the arc between where they touch.
  const double distance = start.norm(), tangent = std::sqrt(distance * distance - 0.09);
  const double between = M_PI - 2.0 * std::asin(0.01 / distance);
  const double arc = kRadius * (between - 2.0 * std::acos(kRadius / distance));
  EXPECT_NEAR(path.length_m, 2.0 * tangent + arc, 0.01);
  for (const auto& p : path.points) EXPECT_GE(p.norm(), kRadius);
}

TEST(PathPlanner, SaysWhyThereIsNoPath) {
  const auto wall = [](const Vector2d& p, const Vector2d&) {
    return std::abs(p.x()) < 0.2 ? kInf : 1.0;
  };
  EXPECT_EQ(PlanPath(wall, Problem({-0.5, 0}, {0.5, 0}, 0.05)).status, PathStatus::kNoPath);
  EXPECT_EQ(PlanPath(wall, Problem({0.1, 0}, {0.5, 0}, 0.05)).status,
            PathStatus::kStartOrGoalOutside);
  EXPECT_EQ(PlanPath(wall, Problem({0.5, 0}, {1.5, 0}, 0.05)).status,
            PathStatus::kStartOrGoalOutside);
}

TEST(PathPlanner, ResamplesWithoutMovingCorners) {
  const std::vector<Vector2d> corners{{0, 0}, {1, 0}, {1, 0.25}};
  const auto fine = Resample(corners, 0.1);
  EXPECT_EQ(fine.size(), 14U);
  EXPECT_EQ(fine[10], corners[1]);
  EXPECT_NEAR(LengthOf(fine), 1.25, 1e-12);
}

}  // namespace
}  // namespace flextip
