// The paths of Fig. 2.8: against an integration of their own, and where nothing may bend them.
#include <gtest/gtest.h>

#include <cmath>

#include "reproduction/chapter2/paths/paths.h"

namespace flextip::reproduction {
namespace {

TrajectoryMove Move(double start_z, double goal_z, double goal_y) {
  TrajectoryMove move;
  move.p_start = {start_z, 0.0};
  move.p_goal = {goal_z, goal_y};
  return move;
}

/// (2.2) in the limit of a small gain, by Runge and Kutta in the wrist's coordinates; J_hat from
/// differences of the lever equation.
Eigen::Vector2d WristRate(const TrajectoryMove& move, const Eigen::Vector2d& wrist) {
  const auto tip = [&](const Eigen::Vector2d& port, const Eigen::Vector2d& w) {
    return Eigen::Vector2d(w + move.instrument.shaft_m * (port - w).normalized());
  };
  Eigen::Matrix2d J_hat;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d step = 1e-6 * Eigen::Vector2d::Unit(i);
    J_hat.col(i) =
        (tip(move.p_port_estimated, wrist + step) - tip(move.p_port_estimated, wrist - step)) /
        2e-6;
  }
  return J_hat.inverse() * (move.p_goal - tip(move.instrument.p_port, wrist));
}

TrajectoryPath Integrated(const TrajectoryMove& move) {
  Eigen::Vector2d w = *move.instrument.WristForTip(move.p_start);
  TrajectoryPath path;
  const double h = 0.01;
  for (int i = 0; i < 1200; ++i) {
    path.p_tip.push_back(*move.instrument.Tip(w));
    const Eigen::Vector2d k1 = WristRate(move, w), k2 = WristRate(move, w + 0.5 * h * k1),
                          k3 = WristRate(move, w + 0.5 * h * k2), k4 = WristRate(move, w + h * k3);
    w += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
  return path;
}

TEST(TrajectoryPaths, StepsFollowTheIntegratedPath) {
  for (const TrajectoryMove& move :
       {Move(0.320, 0.340, 0.02), Move(0.415, 0.395, -0.02), Move(0.415, 0.435, 0.0)}) {
    const TrajectoryPath steps = QuasiStaticPath(move, 0.01);
    EXPECT_TRUE(steps.reached);
    // Steps of a finite gain cut the bends; half the gain, half of it.
    const TrajectoryPath reference = Integrated(move);
    const double off = LargestDistance(steps, reference);
    EXPECT_LT(off, 4e-4);
    EXPECT_NEAR(LargestDistance(QuasiStaticPath(move, 0.005), reference) / off, 0.5, 0.1);
  }
}

/// The thesis: the path to (435, 0) moves away from its goal just before it converges.
TEST(TrajectoryPaths, TheOneToTheEdgeMovesAwayFirst) {
  const TrajectoryMove move = Move(0.415, 0.435, 0.0);
  EXPECT_GT(MovesAway(Integrated(move), move.p_goal), 2e-4);
  EXPECT_GT(MovesAway(QuasiStaticPath(move, 0.01), move.p_goal), 2e-4);
  const TrajectoryMove easy = Move(0.320, 0.340, 0.0);
  EXPECT_EQ(MovesAway(QuasiStaticPath(easy, 0.01), easy.p_goal), 0.0);
}

/// With the port known, slow motion is a straight line.
TEST(TrajectoryPaths, AreStraightWithTheTruePort) {
  TrajectoryMove move = Move(0.375, 0.395, 0.02);
  move.p_port_estimated = move.instrument.p_port;
  TrajectoryPath line;
  line.p_tip = {move.p_start, move.p_goal};
  EXPECT_LT(LargestDistance(QuasiStaticPath(move, 0.01), line), 2e-5);
  const TrajectoryPath arm = DynamicPath(move, ArmRig{});
  EXPECT_TRUE(arm.reached);
  EXPECT_LT(LargestDistance(arm, line), 3e-4);
  ArmRig rough;
  rough.friction_N = 0.3;
  EXPECT_GT(LargestDistance(DynamicPath(move, rough), line), 1e-3);
}

/// An arm that is longer than its controller believes records the same path.
TEST(TrajectoryPaths, DoNotShowTheArmsOwnError) {
  const TrajectoryMove move = Move(0.375, 0.355, 0.02);
  ArmRig longer;
  longer.link_error = 0.01;
  EXPECT_LT(LargestDistance(DynamicPath(move, longer), DynamicPath(move, ArmRig{})), 3e-5);
}

TEST(TrajectoryPaths, MeasuresOnPathsByHand) {
  TrajectoryPath path, line;
  path.p_tip = {{0.0, 0.0}, {0.01, 0.003}, {0.02, 0.0}, {0.018, 0.0}, {0.03, 0.0}};
  line.p_tip = {{0.0, 0.0}, {0.03, 0.0}};
  EXPECT_NEAR(LargestDistance(path, line), 0.003, 1e-15);
  EXPECT_NEAR(MovesAway(path, {0.03, 0.0}), 0.002, 1e-15);
  EXPECT_NEAR(LargestHeadingError(path, {0.03, 0.0}, 1e-3), M_PI, 1e-12);
  path.p_tip.resize(3);
  // Up by atan 0.3 with the goal ahead, then down by as much with the goal atan 0.15 below.
  EXPECT_NEAR(LargestHeadingError(path, {0.03, 0.0}, 1e-3), std::atan(0.3), 1e-12);
}

}  // namespace
}  // namespace flextip::reproduction
