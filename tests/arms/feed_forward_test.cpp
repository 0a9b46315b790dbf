// The gain of an arm's diagnosis where it is to be used: an arm that moves by forces in time has
// something wrong with it that nobody tells; its recording is diagnosed; the answer becomes a
// feed-forward of the same arm. What counts is where its links truly are, on another motion.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arms/diagnose/diagnose.h"
#include "arms/feed_forward/joint_model.h"
#include "arms/feed_forward/sampled_path.h"
#include "simulation/closed_loop/joints/joint_loop.h"
#include "simulation/joints/arm_recording.h"
#include "tests/arms/wrist_of_cables.h"

namespace flextip::arms {
namespace {

using simulation::ArmFaults;
using simulation::ArmSensors;
using simulation::JointLoopResult;
using simulation::JointLoopSetup;
using simulation::SmallArm;

Eigen::Vector3d V(double a, double b, double c) { return {a, b, c}; }

/// Half of an encoder offset within tolerance. A healthy arm of this plant is left with 0.2 mrad:
/// 7 Nm on its cables of 40 kNm/rad, and half a cycle.
constexpr double kHealthy_rad = 2.5e-4;

const ArmSensors kSeen{.command = true, .encoders = true, .seen = true};
const ArmSensors kAll{.command = true, .encoders = true, .seen = true, .torque = true};

struct Gain {
  JointLoopResult base, extended;
  /// What is left of a joint's error, root mean square.
  double Left(int joint) const { return extended.rms[joint] / base.rms[joint]; }
  double TipLeft() const { return extended.tip_rms_m / base.tip_rms_m; }
};

struct How {
  bool measured_effort = false;
  std::vector<std::string> without;  ///< effects that the diagnosis does not know
  bool gravity = false;              ///< whatever the plant says
};

Gain GainOf(const ArmFaults& faults, const ArmSensors& sensors, const How& how = {}) {
  const Arm arm = SmallArm();
  const Recording recording = RecordArm(arm, faults, sensors, {.seconds = 10.0});
  const ArmResult found = Diagnose({ArmData(recording, "hidden")}, {.without = how.without});
  JointLoopSetup setup;
  setup.plant = PlantOf(arm, faults);
  if (how.gravity) setup.plant.gravity_m_s2 = {0.0, 0.0, -9.81};
  setup.encoder_offset = faults.encoder_offset;
  setup.encoder_scale = faults.encoder_scale;
  setup.motion = simulation::MotionOf({V(0.2, 0.2, 0.1), V(0.3, 0.3, 0.03), 0.4, 99});
  setup.seconds = 5.0;
  setup.T_LK = *arm.T_LK;
  setup.measured_effort = how.measured_effort;
  Gain gain;
  gain.base = RunJointLoop(setup);
  setup.model = CommandModelOf(arm, found.model, setup.plant.gravity_m_s2).joints;
  gain.extended = RunJointLoop(setup);
  static int runs = 0;
  const std::string run = "run" + std::to_string(++runs);
  for (int i = 0; i < 3; ++i) {
    const std::string joint = run + "_q" + std::to_string(i + 1);
    testing::Test::RecordProperty(joint + "_before", std::to_string(gain.base.rms[i]));
    testing::Test::RecordProperty(joint + "_after", std::to_string(gain.extended.rms[i]));
  }
  return gain;
}

const ArmFaults kSoftServo{.servo_stiffness = V(200.0, 150.0, 1e6),
                           .servo_damping = V(8.0, 6.0, 1e3),
                           .servo_holds_gravity = false};

TEST(FeedForward, HelpsAHealthyArmToo) {
  const Gain gain = GainOf({}, kAll);  // its servo's own millisecond; its cables' stretch stays
  for (int i = 0; i < 3; ++i) EXPECT_LT(gain.Left(i), 1.0);
  EXPECT_LT(gain.TipLeft(), 0.8);
  for (int i = 0; i < 2; ++i) EXPECT_LT(gain.extended.rms[i], kHealthy_rad);
}

TEST(FeedForward, TakesAnOffsetAway) {
  const Gain gain = GainOf({.encoder_offset = V(0.0, 0.02, 0.0)}, kSeen);
  EXPECT_NEAR(gain.base.rms[1], 0.02, 0.001);
  EXPECT_LT(gain.Left(1), 0.02);
  EXPECT_LT(gain.TipLeft(), 0.02);
}

TEST(FeedForward, TakesACouplingAway) {
  Eigen::MatrixXd routing = Eigen::Matrix3d::Identity();
  routing(1, 0) = 0.05;
  const Gain gain = GainOf({.routing = routing}, kSeen);
  EXPECT_GT(gain.base.rms[1], 0.008);
  EXPECT_LT(gain.Left(1), 0.03);
}

TEST(FeedForward, TakesPlayUp) {
  const Gain gain = GainOf({.play = V(0.0, 0.03, 0.0)}, kSeen);
  EXPECT_GT(gain.base.rms[1], 0.012);
  EXPECT_LT(gain.Left(1), 0.02);
  EXPECT_LT(gain.extended.max[1], 0.001);
}

TEST(FeedForward, LooksAheadByALatency) {
  const Gain gain = GainOf({.command_delay_s = 0.04}, kSeen);
  EXPECT_GT(gain.base.rms[1], 0.006);
  EXPECT_LT(gain.Left(1), 0.05);
  for (int i = 0; i < 2; ++i) EXPECT_LT(gain.extended.rms[i], kHealthy_rad);
}

TEST(FeedForward, TakesLagAndDroopAway) {
  const Gain gain = GainOf(kSoftServo, kAll);
  EXPECT_GT(gain.base.rms[0], 0.03);
  EXPECT_LT(gain.Left(0), 0.01);
  EXPECT_LT(gain.Left(1), 0.05);
}

TEST(FeedForward, TakesLagAndDroopOfAnUntoldPayloadAway) {
  ArmFaults faults = kSoftServo;
  faults.payload = {{2, 0.4, {0.05, 0.0, 0.1}}};
  const Gain gain = GainOf(faults, kAll, {.measured_effort = true});
  EXPECT_GT(gain.base.rms[0], 0.04);
  EXPECT_LT(gain.Left(0), 0.01);
  // Nobody told the diagnosis of payloads: the motors' efforts tell the feed-forward.
  const Gain without = GainOf(faults, kAll, {.measured_effort = true, .without = {"payload"}});
  EXPECT_LT(without.Left(0), 0.02);
}

TEST(FeedForward, TakesYieldingCablesAway) {
  const Gain gain = GainOf({.cable_stiffness = V(300.0, 300.0, 4e6)}, kAll);
  EXPECT_GT(gain.base.rms[0], 0.02);
  EXPECT_LT(gain.Left(0), 0.04);
}

TEST(FeedForward, TakesTwoAtOnceAway) {
  const Gain late = GainOf({.play = V(0.0, 0.03, 0.0), .command_delay_s = 0.04}, kSeen);
  EXPECT_GT(late.base.rms[1], 0.015);
  EXPECT_LT(late.Left(0), 0.05);
  EXPECT_LT(late.Left(1), 0.02);
  Eigen::MatrixXd routing = Eigen::Matrix3d::Identity();
  routing(1, 0) = 0.05;
  const Gain two = GainOf({.encoder_offset = V(0.02, 0.0, 0.0), .routing = routing}, kSeen);
  EXPECT_LT(two.Left(0), 0.03);
  EXPECT_LT(two.Left(1), 0.03);
}

// Forms that the model does not have.

TEST(FeedForward, FrictionInAServoThatHoldsGravityStays) {
  ArmFaults stick = kSoftServo;
  stick.servo_holds_gravity = true;  // its effort says nothing of how far it stands off
  stick.motor_coulomb = V(1.0, 1.0, 0.0);
  const Gain gain = GainOf(stick, kAll);
  EXPECT_LT(gain.Left(0), 0.7);  // the lag goes, 1 Nm over 200 and 150 Nm/rad stays
  EXPECT_LT(gain.Left(1), 0.5);
  EXPECT_NEAR(gain.extended.rms[0], 1.0 / 200.0, 0.0015);
  EXPECT_NEAR(gain.extended.rms[1], 1.0 / 150.0, 0.002);
}

TEST(FeedForward, WhatIsTakenForAnotherCauseDoesNoHarm) {
  const Gain gain = GainOf({.play = V(0.0, 0.03, 0.0)}, kSeen, {.without = {"joint_backlash"}});
  // A fifth of a tolerance is none.
  for (int i = 0; i < 3; ++i) EXPECT_LT(gain.extended.rms[i], gain.base.rms[i] + 1e-4);
}

// A limit: which side of its play a link hangs on by gravity is not what its motion says. Where a
// recording without gravity on the joint showed the play, it is crossed in vain.
TEST(FeedForward, PlayThatHangsByGravityIsNotKnown) {
  const Gain gain = GainOf({.play = V(0.03, 0.0, 0.0)}, kSeen, {.gravity = true});
  EXPECT_NEAR(gain.base.rms[0], 0.015, 0.001);
  EXPECT_GT(gain.Left(0), 1.0);
  EXPECT_LT(gain.Left(0), 1.5);
}

// A wrist by forces, found and led along another motion: its springs are taken away, its plays too
// but for what one carries of the other.
TEST(FeedForward, LeadsAWristThatSpringsPullBack) {
  const WristOfCables wrist{.spring_x = 0.1, .spring_y = 0.15};
  const std::vector<double> noise{3e-4, 2e-4, 5e-5, 1e-3, 4e-4, 6e-4};
  const Recording recording = RecordedWrist(wrist, noise, 25, 0.5);
  const ArmResult found = Diagnose({ArmData(recording, "wrist")});
  const ArmData other(RecordedWrist(wrist, noise, 26, 0.0), "other");
  const SampledPath path(other.joints);
  const PathCommands commands =
      CommandsFor(path, CommandModelOf(*recording.arm, found.model, {0.0, 0.0, -9.81}).joints,
                  {.max_correction = Eigen::VectorXd::Constant(6, 1.5)});
  const auto error = [&](const Eigen::MatrixXd& motors) {
    const Eigen::MatrixXd two = motors.rightCols(2);
    const Eigen::Vector2d at = wrist.HowFar() * two.row(0).transpose();
    const Eigen::MatrixXd off = wrist.Follow(two, at) - path.Rows().values.rightCols(2);
    return Eigen::Vector2d((off.array().square().colwise().sum() / double(off.rows())).sqrt());
  };
  const Eigen::Vector2d before = error(path.Rows().values), after = error(commands.q);
  for (int i = 0; i < 2; ++i) {
    const std::string joint = "wrist_q" + std::to_string(i + 5);
    RecordProperty(joint + "_before", std::to_string(before[i]));
    RecordProperty(joint + "_after", std::to_string(after[i]));
    EXPECT_GT(before[i], 0.1);
    EXPECT_LT(after[i], 0.5 * before[i]);
  }
}

}  // namespace
}  // namespace flextip::arms
