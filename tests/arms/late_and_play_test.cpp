// Delays, lags and play against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "arms/effects/late.h"
#include "arms/effects/play.h"
#include "tests/arms/wrist_of_cables.h"

namespace flextip::arms {
namespace {

const Eigen::VectorXd kTimes = Eigen::VectorXd::LinSpaced(2001, 0.0, 20.0);

TEST(Late, DelayedSineIsASineOfAnEarlierTime) {
  const Eigen::VectorXd x = (2.0 * kTimes).array().sin();
  const Eigen::VectorXd late = Delayed(kTimes, x, 0.037);
  for (Eigen::Index k = 100; k < 2000; k += 50)
    EXPECT_NEAR(late[k], std::sin(2.0 * (kTimes[k] - 0.037)), 1e-6);
}

TEST(Late, LaggedSineHasTheGainAndPhaseOfAFirstOrderLag) {
  constexpr double w = 2.0, T = 0.08;
  const Eigen::VectorXd x = (w * kTimes).array().sin();
  const Eigen::VectorXd lagged = Lagged(kTimes, x, T);
  const double gain = 1.0 / std::sqrt(1.0 + w * w * T * T), phase = std::atan(w * T);
  // Straight lines between samples are off by the step squared times the curvature over 12.
  constexpr double bend = 0.01 * 0.01 * w * w / 12.0;
  for (Eigen::Index k = 200; k < 2000; k += 50)
    EXPECT_NEAR(lagged[k], gain * std::sin(w * kTimes[k] - phase), 1.02 * bend);
}

TEST(Late, LagGrowsSmoothlyFromZero) {
  const Eigen::VectorXd x = (1.5 * kTimes).array().sin();
  const Eigen::VectorXd up = Lagged(kTimes, x, 1e-4), down = Lagged(kTimes, x, -1e-4);
  // The slopes before a sample and about it differ by half a step times the curvature.
  EXPECT_LT((up + down - 2.0 * x).cwiseAbs().maxCoeff(), 1e-4 * 0.5 * 0.01 * 1.5 * 1.5 * 1.01);
}

TEST(Play, FollowerStaysWhileItsLeaderTurnsBack) {
  Eigen::VectorXd x(7);
  x << 0.0, 1.0, 0.95, 0.92, 0.0, 0.05, 1.0;
  const Eigen::VectorXd state = PlayState(x, 0.1);
  const Eigen::VectorXd follower = x + 0.1 * state;
  EXPECT_DOUBLE_EQ(state[1], -0.5);
  EXPECT_NEAR(follower[2], follower[1], 1e-12);  // within the play: it stays
  EXPECT_NEAR(follower[3], follower[1], 1e-12);
  EXPECT_DOUBLE_EQ(state[4], 0.5);
  EXPECT_NEAR(follower[5], follower[4], 1e-12);
  EXPECT_DOUBLE_EQ(state[6], -0.5);
}

TEST(Play, WithoutWidthIsTheDirectionWithItsMemory) {
  Eigen::VectorXd x(5);
  x << 0.0, 0.1, 0.1, -0.2, -0.1;
  const Eigen::VectorXd state = PlayState(x, 0.0);
  EXPECT_EQ(state, (Eigen::VectorXd(5) << 0.0, -0.5, -0.5, 0.5, -0.5).finished());
}

TEST(Play, BeginsWhereItIsSaidTo) {
  Eigen::VectorXd x(4);
  x << 0.0, 0.0, 0.02, 0.3;
  const Eigen::VectorXd state = PlayState(x, 0.1, 0.4);
  EXPECT_LT((state - Eigen::Vector4d(0.4, 0.4, 0.2, -0.5)).norm(), 1e-12);
}

/// Two motors that turn back and forth out of step.
Eigen::MatrixXd TwoMotors() {
  constexpr Eigen::Index kRows = 12800;
  Eigen::MatrixXd motors(kRows, 2);
  for (Eigen::Index k = 0; k < kRows; ++k)
    motors.row(k) << 0.7 * std::sin(0.0015 * double(k)) + 0.2 * std::sin(0.01 * double(k)),
        0.9 * std::sin(0.0026 * double(k));
  return motors;
}

// Plays that drag each other are springs and friction. The two agree as steps get
// small: a row moves a motor by 3 mrad at most.
void ExpectStatesAndForcesAgree(const WristOfCables& wrist) {
  const Eigen::MatrixXd motors = TwoMotors(), moved = wrist.Moved();
  PlayHistory history{moved.diagonal(), moved};
  history.carried.diagonal().setZero();
  const Eigen::MatrixXd drawn = motors - motors * DrawnBack(history, wrist.PullBack()).transpose();
  const Eigen::Vector2d start{0.3, -0.5};
  const Eigen::Vector2d at = drawn.row(0).transpose() + moved * start;
  const Eigen::MatrixXd by_forces = wrist.Follow(motors, at);
  const Eigen::MatrixXd by_states =
      drawn + CarriedStates(drawn, history.windows, history.carried, start) * moved.transpose();
  EXPECT_LT((by_forces - by_states).cwiseAbs().maxCoeff(), 1e-3) << wrist.over;
  EXPECT_GT((by_states - motors).cwiseAbs().maxCoeff(), 0.1);
}

TEST(Play, JointsThatDragEachOtherAreWhereForcesLeadThem) {
  for (const double over : {0.0, 0.4, 0.9}) ExpectStatesAndForcesAgree({.over = over});
}

// What gives way to friction gives way to a spring.
TEST(Play, SpringsThatPullJointsBackDrawThemByTheShapesOfTheirPlays) {
  for (const double over : {0.4, 0.9})
    ExpectStatesAndForcesAgree({.over = over, .spring_x = 0.2, .spring_y = 0.1});
}

}  // namespace
}  // namespace flextip::arms
