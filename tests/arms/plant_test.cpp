// Arms by forces in time (simulation/joints), which share nothing with the diagnosis: what is put
// into the plant is found in its recordings, and a healthy plant gives none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "arms/diagnose/diagnose.h"
#include "simulation/joints/arm_recording.h"

namespace flextip::arms {
namespace {

using simulation::ArmFaults;
using simulation::ArmMotion;
using simulation::ArmSensors;
using simulation::RecordArm;
using simulation::SmallArm;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;
using testing::UnorderedElementsAre;

Eigen::Vector3d V(double a, double b, double c) { return {a, b, c}; }

ArmResult DiagnosisOf(const ArmFaults& faults, const ArmSensors& sensors,
                      const ArmMotion& motion = {}, const ArmOptions& options = {}) {
  return Diagnose({ArmData(RecordArm(SmallArm(), faults, sensors, motion), "plant")}, options);
}

const ArmSensors kSeen{.command = false, .encoders = true, .seen = true};
const ArmSensors kPose{.command = false, .encoders = true, .pose = true};
const ArmSensors kTorque{.command = false, .encoders = true, .torque = true};
const ArmSensors kCommand{.command = true, .encoders = true};
const ArmSensors kServo{.command = true, .encoders = true, .torque = true};

double Value(const ArmResult& result, const std::string& effect, const std::string& parameter,
             int i = 0) {
  for (const auto& fit : result.answer.parameters)
    for (const auto& p : fit.parameters)
      if (fit.effect == effect && p.name == parameter) return p.value[i];
  return std::nan("");
}

TEST(ArmPlant, LosesNoEnergyWithoutServoAndFriction) {
  const Arm arm = SmallArm();
  simulation::ArmPlantSettings settings{.arm = arm, .drives = {}, .masses = {}, .routing = {}};
  settings.servo_holds_gravity = false;
  for (int i = 0; i < 3; ++i) {
    simulation::JointDrive drive;
    drive.servo_stiffness = drive.servo_damping = drive.cable_stiffness = drive.cable_damping = 0.0;
    settings.drives.push_back(drive);
    settings.masses.push_back({i, arm.links[i].mass_kg, arm.links[i].com_m});
  }
  const Eigen::VectorXd t_s = Eigen::VectorXd::LinSpaced(41, 0.0, 0.4);
  const simulation::ChainOfLinks chain(arm);
  const auto energy = [&](const simulation::ArmPlantState& s) {
    const auto dynamics =
        DynamicsOf(chain, settings.masses, s.link, s.link_speed, settings.gravity_m_s2);
    double sum =
        0.5 * s.link_speed.dot(dynamics.M * s.link_speed) + 0.5 * 2e-3 * s.link_speed.squaredNorm();
    for (const auto& mass : settings.masses)
      sum -= mass.mass_kg * settings.gravity_m_s2.dot(chain.Point(s.link, mass));
    return sum;
  };
  const auto lost = [&](double step_s) {
    settings.links_step_s = step_s;
    const auto states = simulation::RunArm(settings, t_s, Eigen::MatrixXd::Constant(41, 3, 0.1));
    EXPECT_GT(states.back().link_speed.norm(), 0.5);  // it falls
    return std::abs(energy(states.back()) - energy(states.front()));
  };
  // What is lost is the steps' alone: of first order, and a step of a tenth keeps the energy.
  EXPECT_NEAR(lost(1e-3) / lost(1e-4), 10.0, 1.5);
  EXPECT_LT(lost(1e-4), 0.02);  // J, of some 2 that move
}

TEST(ArmPlant, HealthyArmGivesNone) {
  for (const ArmSensors& sensors : {kSeen, kPose, kTorque, kCommand, kServo})
    EXPECT_THAT(DiagnosisOf({}, sensors).answer.verdict, ElementsAre("none"));
}

TEST(ArmPlant, EncoderOffsetIsFound) {
  const ArmResult result = DiagnosisOf({.encoder_offset = V(0.0, 0.02, 0.0)}, kSeen);
  EXPECT_THAT(result.answer.verdict, ElementsAre("joint_offset"));
  EXPECT_NEAR(Value(result, "joint_offset", "offset", 1), 0.02, 0.001);
}

TEST(ArmPlant, EncoderScaleIsFound) {
  const ArmResult result = DiagnosisOf({.encoder_scale = V(0.02, 0.0, 0.0)}, kSeen);
  EXPECT_THAT(result.answer.verdict, ElementsAre("joint_scale"));
  EXPECT_NEAR(Value(result, "joint_scale", "scale", 0), 1.02, 0.002);
}

TEST(ArmPlant, CablesThatPullAnotherJointAreFound) {
  Eigen::MatrixXd routing = Eigen::Matrix3d::Identity();
  routing(1, 0) = 0.05;
  const ArmResult result = DiagnosisOf({.routing = routing}, kSeen);
  EXPECT_THAT(result.answer.verdict, ElementsAre("joint_coupling"));
  EXPECT_NEAR(Value(result, "joint_coupling", "matrix", 2), 0.05, 0.003);
}

TEST(ArmPlant, PlayIsFound) {
  const ArmResult result = DiagnosisOf({.play = V(0.0, 0.03, 0.0)}, kSeen);
  EXPECT_THAT(result.answer.verdict, ElementsAre("joint_backlash"));
  EXPECT_NEAR(Value(result, "joint_backlash", "width", 1), 0.03, 0.004);
}

TEST(ArmPlant, YieldingCablesAreFound) {
  ArmSensors sensors = kSeen;
  sensors.command = sensors.torque = true;
  const ArmResult result = DiagnosisOf({.cable_stiffness = V(4e4, 300.0, 4e6)}, sensors);
  EXPECT_THAT(result.answer.verdict, Contains("joint_compliance"));
  EXPECT_NEAR(Value(result, "joint_compliance", "compliance", 1), 1.0 / 300.0, 4e-4);
}

TEST(ArmPlant, FrictionOfAMotorIsFound) {
  const ArmResult result =
      DiagnosisOf({.motor_coulomb = V(0.3, 0.2, 0.0), .motor_viscous = V(0.0, 0.4, 0.0)}, kTorque);
  EXPECT_THAT(result.answer.verdict, ElementsAre("joint_friction"));
  EXPECT_NEAR(Value(result, "joint_friction", "coulomb", 0), 0.3, 0.03);
  EXPECT_NEAR(Value(result, "joint_friction", "viscous", 1), 0.4, 0.04);
}

TEST(ArmPlant, PayloadIsFoundWithItsPlace) {
  for (const ArmSensors& sensors : {kTorque, kServo}) {
    const ArmResult result =
        DiagnosisOf({.payload = {{2, 0.2, {0.05, 0.0, 0.1}}}}, sensors);  // the place "slide"
    EXPECT_THAT(result.answer.verdict, ElementsAre("payload"));
    EXPECT_NEAR(Value(result, "payload", "mass_kg"), 0.2, 0.01);
    EXPECT_EQ(Value(result, "payload", "link"), 3.0);
  }
}

// A known effect takes part of each up, and leaves a function of the joints that no other has.
TEST(ArmPlant, WhatTheCatalogueLacksIsUnknown) {
  const ArmFaults offset{.encoder_offset = V(0.0, 0.02, 0.0)}, late{.command_delay_s = 0.12};
  EXPECT_THAT(DiagnosisOf(offset, kSeen, {}, {.without = {"joint_offset"}}).answer.verdict,
              ElementsAre("unknown"));
  EXPECT_THAT(DiagnosisOf(late, kCommand, {}, {.without = {"command_latency"}}).answer.verdict,
              ElementsAre("unknown"));
}

const ArmSensors kWithoutSeen{.command = true, .encoders = true, .pose = true, .torque = true};

// Links that are not where they are said to be weigh elsewhere: that is no payload.
TEST(ArmPlant, WhatMovesALinkIsNoPayload) {
  const ArmResult moved = DiagnosisOf(
      {.encoder_offset = V(0.0, 0.027, 0.0), .a_change_m = V(0.0, 0.01, 0.0)}, kWithoutSeen);
  EXPECT_THAT(moved.answer.verdict, UnorderedElementsAre("joint_offset", "link_geometry"));
}

// The motor of a cable that pulls a joint is pulled by it: its efforts are predicted to their
// noise.
TEST(ArmPlant, CablesThatPullAJointArePulledByIt) {
  Eigen::MatrixXd routing = Eigen::Matrix3d::Identity();
  routing(0, 1) = 0.054;
  const ArmResult pulled = DiagnosisOf({.routing = routing}, kWithoutSeen);
  EXPECT_THAT(pulled.answer.verdict, ElementsAre("joint_coupling"));
  EXPECT_NEAR(Value(pulled, "joint_coupling", "matrix", 0), 0.054, 5e-4);
  const auto error = [](const diagnosis::ModelScore& score) {
    return score.heldout_rms.at("torque0_tau2_Nm");
  };
  RecordProperty("tau2_before", std::to_string(error(pulled.answer.base)));
  RecordProperty("tau2_after", std::to_string(error(pulled.answer.extended)));
  EXPECT_LT(error(pulled.answer.extended), 0.02);
}

TEST(ArmPlant, LateCommandsAreFound) {
  for (const ArmSensors& sensors : {kCommand, kServo}) {
    const ArmResult result = DiagnosisOf({.command_delay_s = 0.04}, sensors);
    EXPECT_THAT(result.answer.verdict, ElementsAre("command_latency"));
    EXPECT_NEAR(Value(result, "command_latency", "delay_s"), 0.04, 0.002);
  }
}

TEST(ArmPlant, SoftServoLagsAndDroops) {
  const ArmResult result = DiagnosisOf({.servo_stiffness = V(200.0, 150.0, 1e6),
                                        .servo_damping = V(8.0, 6.0, 1e3),
                                        .servo_holds_gravity = false},
                                       kServo);
  EXPECT_THAT(result.answer.verdict, Contains("servo_droop"));
  EXPECT_THAT(result.answer.verdict, Contains("servo_lag"));
  EXPECT_NEAR(Value(result, "servo_droop", "compliance", 1), 1.0 / 150.0, 3e-4);
  EXPECT_NEAR(Value(result, "servo_lag", "time_s", 1), 0.04, 0.004);
  EXPECT_LT(result.answer.gain.heldout_error_ratio, 0.05);
}

TEST(ArmPlant, LinkLengthIsFoundByATracker) {
  const ArmResult result = DiagnosisOf({.a_change_m = V(0.0, 0.004, 0.0)}, kPose);
  EXPECT_THAT(result.answer.verdict, ElementsAre("link_geometry"));
  EXPECT_NEAR(Value(result, "link_geometry", "a_m", 1), 0.004, 0.0005);
}

TEST(ArmPlant, MarkerAndTrackerAreFound) {
  const ArmResult marker = DiagnosisOf({.marker_m = {0.0, 0.004, 0.0}}, kPose);
  EXPECT_THAT(marker.answer.verdict, ElementsAre("tool_offset"));
  const ArmResult tracker = DiagnosisOf({.tracker_m = {0.006, 0.0, -0.004}}, kPose);
  EXPECT_THAT(tracker.answer.verdict, ElementsAre("tracker_registration"));
}

TEST(ArmPlant, TwoAtOnceAreBothFound) {
  Eigen::MatrixXd routing = Eigen::Matrix3d::Identity();
  routing(1, 0) = 0.06;
  const ArmResult result =
      DiagnosisOf({.encoder_offset = V(0.015, 0.0, 0.0), .routing = routing}, kSeen);
  EXPECT_THAT(result.answer.verdict,
              testing::UnorderedElementsAre("joint_coupling", "joint_offset"));
}

}  // namespace
}  // namespace flextip::arms
