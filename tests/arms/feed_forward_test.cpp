// The gain of an arm's diagnosis where it is to be used: an arm that moves by forces in time has
// something wrong with it that nobody tells; its recording is diagnosed; the answer becomes a
// feed-forward of the same arm. What counts is where its links truly are.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arms/diagnose/diagnose.h"
#include "arms/feed_forward/joint_model.h"
#include "simulation/closed_loop/joints/joint_loop.h"
#include "simulation/joints/arm_recording.h"

namespace flextip::arms {
namespace {

using simulation::ArmFaults;
using simulation::ArmSensors;
using simulation::JointLoopResult;
using simulation::JointLoopSetup;
using simulation::SmallArm;

Eigen::Vector3d V(double a, double b, double c) { return {a, b, c}; }

const ArmSensors kAll{.command = true, .encoders = true, .seen = true, .torque = true};
const ArmSensors kSeen{.command = true, .encoders = true, .seen = true};

struct Gain {
  JointLoopResult base, extended;
  double Ratio(int joint) const { return extended.rms[joint] / base.rms[joint]; }
  double Tip() const { return extended.tip_rms_m / base.tip_rms_m; }
};

JointLoopSetup LoopOf(const ArmFaults& faults) {
  JointLoopSetup setup;
  setup.plant = PlantOf(SmallArm(), faults);
  setup.encoder_offset = faults.encoder_offset;
  setup.encoder_scale = faults.encoder_scale;
  setup.motion = simulation::MotionOf({V(0.2, 0.2, 0.1), V(0.3, 0.3, 0.03), 0.4, 99});
  setup.seconds = 6.0;
  setup.T_LK = *SmallArm().T_LK;
  return setup;
}

Gain GainOf(const ArmFaults& faults, const ArmSensors& sensors, bool measured_effort = false) {
  const Arm arm = SmallArm();
  const Recording recording = RecordArm(arm, faults, sensors, {.seconds = 12.0});
  const ArmResult found = Diagnose({ArmData(recording, "hidden")});
  JointLoopSetup setup = LoopOf(faults);
  Gain gain;
  gain.base = RunJointLoop(setup);
  setup.model = CommandModelOf(arm, found.model, setup.plant.gravity_m_s2).joints;
  setup.measured_effort = measured_effort;
  gain.extended = RunJointLoop(setup);
  std::string said;
  for (const auto& v : found.answer.verdict) said += v + " ";
  for (int i = 0; i < 3; ++i)
    fmt::print("{} q{}: rms {:.3f} -> {:.3f}, max {:.3f} -> {:.3f} (mrad, mm)\n", said, i + 1,
               1e3 * gain.base.rms[i], 1e3 * gain.extended.rms[i], 1e3 * gain.base.max[i],
               1e3 * gain.extended.max[i]);
  fmt::print("{} tip: rms {:.3f} -> {:.3f} mm\n", said, 1e3 * gain.base.tip_rms_m,
             1e3 * gain.extended.tip_rms_m);
  return gain;
}

TEST(FeedForward, A0) { GainOf({}, kAll); }
TEST(FeedForward, A1) { GainOf({.encoder_offset = V(0.0, 0.02, 0.0)}, kSeen); }
TEST(FeedForward, A2) { GainOf({.encoder_scale = V(0.05, 0.0, 0.0)}, kSeen); }
TEST(FeedForward, A3) {
  Eigen::MatrixXd routing = Eigen::Matrix3d::Identity();
  routing(1, 0) = 0.05;
  GainOf({.routing = routing}, kSeen);
}
TEST(FeedForward, A4) { GainOf({.play = V(0.0, 0.03, 0.0)}, kSeen); }
TEST(FeedForward, A5) { GainOf({.command_delay_s = 0.04}, kSeen); }
TEST(FeedForward, A6) {
  const ArmFaults soft{.servo_stiffness = V(200.0, 150.0, 1e6),
                       .servo_damping = V(8.0, 6.0, 1e3),
                       .servo_holds_gravity = false};
  GainOf(soft, kAll);
  GainOf(soft, kAll, true);
}
TEST(FeedForward, A7) {
  GainOf({.servo_stiffness = V(5e3, 5e3, 5e5), .servo_damping = V(200, 5, 500)}, kSeen);
}
TEST(FeedForward, A8) { GainOf({.cable_stiffness = V(4e4, 300.0, 4e6)}, kAll); }
TEST(FeedForward, A9) { GainOf({.play = V(0.0, 0.03, 0.0), .command_delay_s = 0.04}, kSeen); }

}  // namespace
}  // namespace flextip::arms
