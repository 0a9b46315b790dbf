// The feed-forward of joints against arms that are simulated here by differential equations of
// their own, and whatever comes in.
#include "control/joints/joint_feed_forward.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/error.h"
#include "tests/control/allocation_counter.h"
#include "tests/hostile_numbers.h"

namespace flextip {
namespace {

constexpr double kStep_s = 1e-3;

JointVector V(double a, double b) {
  JointVector v(2);
  v << a, b;
  return v;
}

/// 0.3 sin(2 t) and a ramp up that stops at 2 s.
JointWish WishAt(double t) {
  const double s = std::min(t, 2.0) / 2.0;
  const double rest = t < 2.0 ? 1.0 : 0.0;
  return {V(0.3 * std::sin(2.0 * t), 0.2 * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s)),
          V(0.6 * std::cos(2.0 * t), rest * 3.0 * s * s * (1.0 - s) * (1.0 - s)),
          V(-1.2 * std::sin(2.0 * t), rest * 3.0 * s * (1.0 - s) * (1.0 - 2.0 * s)),
          {}};
}

JointWish AheadOf(const JointFeedForward& feed_forward, double t) {
  JointWish wish = WishAt(t + feed_forward.Lead_s());
  wish.v_ahead.resize(2);
  for (int j = 0; j < 2; ++j)
    wish.v_ahead[j] = WishAt(t + feed_forward.Lead_s() + feed_forward.TurnAhead_s()[j]).v[j];
  return wish;
}

/// Commands at every millisecond from 0 to 4 s.
std::vector<JointVector> CommandsOf(const JointModel& model, bool ahead = true) {
  JointFeedForward feed_forward(model, {}, WishAt(0.0).q);
  std::vector<JointVector> commands;
  for (int k = 0; k < 4000; ++k) {
    JointWish wish = AheadOf(feed_forward, k * kStep_s);
    if (!ahead) wish.v_ahead.resize(0);
    commands.push_back(feed_forward.Step(wish, kStep_s).q);
  }
  return commands;
}

TEST(JointFeedForward, LagAndDelayAreMadeUpFor) {
  JointModel model(2);
  model.lag_s = V(0.05, 0.02);
  model.delay_s = 0.03;
  const auto commands = CommandsOf(model);
  JointVector q = WishAt(0.0).q;
  double worst = 0.0, without = 0.0;
  JointVector plain = q;
  for (int k = 0; k < 4000; ++k) {
    // T q' = command - q by its exact step, commands late by 30 rows.
    const auto follow = [&](JointVector& x, const JointVector& command) {
      for (int i = 0; i < 2; ++i)
        x[i] += (1.0 - std::exp(-kStep_s / model.lag_s[i])) * (command[i] - x[i]);
    };
    follow(q, commands[std::size_t(std::max(0, k - 30))]);
    follow(plain, WishAt(std::max(0.0, k * kStep_s - 0.03)).q);
    if (k < 500) continue;
    worst = std::max(worst, (q - WishAt((k + 1) * kStep_s).q).cwiseAbs().maxCoeff());
    without = std::max(without, (plain - WishAt((k + 1) * kStep_s).q).cwiseAbs().maxCoeff());
  }
  EXPECT_GT(without, 0.04);
  EXPECT_LT(worst, 0.001);  // a held command's half a step, and the step of the row
}

/// A link that a motor takes along when it has crossed the play.
class Dragged {
 public:
  Dragged(double width, double at) : width_(width), link_(at) {}
  double Move(double motor) {
    link_ = std::clamp(link_, motor - 0.5 * width_, motor + 0.5 * width_);
    return link_;
  }

 private:
  double width_, link_;
};

TEST(JointFeedForward, PlayIsCrossedWhereTheMotionTurns) {
  JointModel model(2);
  model.play(0, 0) = 0.04;
  model.play(1, 1) = 0.02;
  const auto worst = [&](const std::vector<JointVector>& commands) {
    Dragged first(0.04, 0.0), second(0.02, 0.0);
    double most = 0.0;
    for (int k = 0; k < 4000; ++k) {
      const JointVector wish = WishAt(k * kStep_s).q;
      const double a = first.Move(commands[std::size_t(k)][0]) - wish[0],
                   b = second.Move(commands[std::size_t(k)][1]) - wish[1];
      if (k > 300) most = std::max({most, std::abs(a), std::abs(b)});
    }
    return most;
  };
  std::vector<JointVector> plain;
  for (int k = 0; k < 4000; ++k) plain.push_back(WishAt(k * kStep_s).q);
  EXPECT_GT(worst(plain), 0.018);
  const double ahead = worst(CommandsOf(model)), late = worst(CommandsOf(model, false));
  EXPECT_LT(ahead, 0.002);  // half a crossing before and after the turn: a (t/2)^2 / 2
  EXPECT_LT(late, 0.008);   // all of it after the turn
  EXPECT_GT(late, 2.0 * ahead);
}

TEST(JointFeedForward, AStopIsNoTurn) {
  JointModel model(2);
  model.play(1, 1) = 0.02;
  const auto commands = CommandsOf(model);
  EXPECT_NEAR(commands.back()[1], 0.2 + 0.01, 1e-9);  // still on the side of its motion up
}

TEST(JointFeedForward, OffsetScaleAndCouplingAreInverted) {
  JointModel model(2);
  model.offset = V(0.02, -0.01);
  model.scale = V(1.05, 0.98);
  model.coupling(1, 0) = 0.1;
  const auto commands = CommandsOf(model);
  Eigen::Matrix2d gains;
  gains << 1.05, 0.0, 0.1, 0.98;
  for (int k = 500; k < 4000; k += 100) {
    const Eigen::Vector2d truth =
        gains * Eigen::Vector2d(commands[std::size_t(k)]) + Eigen::Vector2d(0.02, -0.01);
    EXPECT_NEAR((truth - Eigen::Vector2d(WishAt(k * kStep_s).q)).norm(), 0.0, 1e-12);
  }
}

TEST(JointFeedForward, AMeasuredEffortFillsWhatIsNotExpected) {
  JointModel model(2);
  model.droop = V(0.01, 0.0);
  JointFeedForward feed_forward(model, {}, V(0.0, 0.0));
  const JointWish still{V(0.0, 0.0), V(0.0, 0.0), V(0.0, 0.0), {}};
  JointCommand command;
  // A servo with a spring of 100 Nm/rad that holds 3 Nm: its effort is what it is, however far its
  // joint is from the wish.
  double joint = -0.03;
  for (int k = 0; k < 5000; ++k) {
    command = feed_forward.Step(still, kStep_s, V(3.0, 0.0));
    joint = command.q[0] - 3.0 / 100.0;
  }
  EXPECT_NEAR(joint, 0.0, 1e-4);
}

TEST(JointFeedForward, SaysWhereItIsLimited) {
  JointModel model(2);
  model.offset = V(0.7, 0.0);
  JointFeedForward feed_forward(model, {}, V(0.0, 0.0));
  const JointWish still{V(0.0, 0.0), V(0.0, 0.0), V(0.0, 0.0), {}};
  const JointCommand first = feed_forward.Step(still, kStep_s);
  EXPECT_TRUE(first.rate_limited);
  EXPECT_TRUE(first.correction_limited);
  EXPECT_NEAR(first.q[0], -0.01, 1e-12);  // 10 rad/s
  JointCommand last;
  for (int k = 0; k < 200; ++k) last = feed_forward.Step(still, kStep_s);
  EXPECT_FALSE(last.rate_limited);
  EXPECT_TRUE(last.correction_limited);
  EXPECT_NEAR(last.q[0], -0.5, 1e-12);
}

TEST(JointFeedForward, WhateverComesInTheCommandIsFiniteAndBounded) {
  Hostile hostile(7);
  EffortJoint link;
  link.mass_kg = 1.0;
  link.moment_kg_m = {0.1, 0.0, 0.0};
  link.R_before = Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  JointModel model(2);
  model.effort.emplace(std::vector<EffortJoint>{link, link}, Eigen::Vector3d(0.0, 0.0, -9.81));
  model.droop = V(0.005, 0.004);
  model.compliance = V(0.001, 0.001);
  model.lag_s = V(0.04, 0.04);
  model.play(0, 0) = 0.03;
  model.play(1, 0) = 0.01;
  JointFeedForward feed_forward(model, {}, V(0.0, 0.0));
  JointVector last = V(0.0, 0.0);
  for (long trial = 0; trial < HostileTrials(20000); ++trial) {
    JointWish wish = WishAt(0.001 * double(trial % 4000));
    double dt_s = kStep_s;
    JointVector effort = V(1.0, 2.0);
    if (hostile.OneIn(2)) wish.q[hostile.Below(2)] = hostile.Wrong(0.1);
    if (hostile.OneIn(3)) wish.v[hostile.Below(2)] = hostile.Wrong(0.1);
    if (hostile.OneIn(3)) wish.a[hostile.Below(2)] = hostile.Wrong(0.1);
    if (hostile.OneIn(3)) effort[hostile.Below(2)] = hostile.Wrong(1.0);
    if (hostile.OneIn(5)) dt_s = hostile.Wrong(kStep_s);
    if (hostile.OneIn(7)) wish.v.resize(1);
    if (hostile.OneIn(7)) effort.resize(0);
    const JointCommand command = feed_forward.Step(wish, dt_s, effort);
    ASSERT_TRUE(command.q.allFinite());
    if (command.status == FeedForwardStatus::kBadInput) {
      ASSERT_EQ(command.q, last);
    } else {
      ASSERT_LE((command.q - last).cwiseAbs().maxCoeff(), 10.0 * dt_s + 1e-9);
    }
    last = command.q;
  }
}

TEST(JointFeedForward, AStepAllocatesNothing) {
  if (!CountsAllocations()) GTEST_SKIP() << "allocations are not counted";
  const int n = 7;
  JointModel model(n);
  model.effort.emplace(std::vector<EffortJoint>(n), Eigen::Vector3d(0.0, 0.0, -9.81));
  model.play(0, 0) = 0.03;
  JointFeedForward feed_forward(model, {}, JointVector::Zero(n));
  const JointWish wish{JointVector::Zero(n), JointVector::Ones(n), JointVector::Ones(n),
                       JointVector::Ones(n)};
  const JointVector effort = JointVector::Ones(n);
  feed_forward.Step(wish, kStep_s, effort);
  const long before = AllocationCount();
  for (int k = 0; k < 100; ++k) feed_forward.Step(wish, kStep_s, effort);
  EXPECT_EQ(AllocationCount(), before);
}

TEST(JointFeedForward, RefusesModelsWithoutMeaning) {
  const JointVector start = V(0.0, 0.0);
  JointModel flat(2);
  flat.scale = V(1.0, 0.0);
  EXPECT_THROW(JointFeedForward(flat, {}, start), InputError);
  JointModel late(2);
  late.delay_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(JointFeedForward(late, {}, start), InputError);
  JointModel short_one(2);
  short_one.lag_s = JointVector::Zero(1);
  EXPECT_THROW(JointFeedForward(short_one, {}, start), InputError);
  EXPECT_THROW(JointModel(0), InputError);
  EXPECT_THROW(JointModel(33), InputError);
}

}  // namespace
}  // namespace flextip
