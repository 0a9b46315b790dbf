// Scenarios of arms with joints: what their effects do to the recording, and what is refused.
#include "simulation/joints/arm_scenario.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <string>

#include "core/error.h"
#include "recording/arm/arm_file.h"

namespace flextip::simulation {
namespace {

using testing::HasSubstr;

class ArmScenarioTest : public testing::Test {
 protected:
  ArmScenarioTest()
      : folder_(std::filesystem::path(testing::TempDir()) /
                ("flextip-arm-scenario-" + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
    WriteArm(folder_ / "arm.yaml", SmallArm());
  }
  ~ArmScenarioTest() override { std::filesystem::remove_all(folder_); }

  ArmScenario Read(const std::string& text) {
    std::ofstream(folder_ / "scenario.yaml") << "arm: arm.yaml\n" << text;
    ReadLog log;
    return ReadArmScenario(folder_ / "scenario.yaml", log);
  }
  std::string Complaint(const std::string& text) {
    try {
      Read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  Recording Record(const std::string& text) {
    const ArmScenario s = Read("motion: {seconds: 6, rate_hz: 50}\n" + text);
    return RecordArm(s.arm, s.faults, s.sensors, s.motion);
  }

  std::filesystem::path folder_;
};

/// The mean over the recording of one joint as seen less as measured.
double MeanDifference(const JointStream& a, const JointStream& b, Eigen::Index joint) {
  double sum = 0.0;
  for (std::size_t k = 0; k < a.q.size(); ++k)
    sum += a.q.at(k).value[joint] - b.q.at(k).value[joint];
  return sum / double(a.q.size());
}

TEST_F(ArmScenarioTest, IsOneWhereItNamesAnArm) {
  Read("");
  EXPECT_TRUE(IsArmScenario(folder_ / "scenario.yaml"));
  std::ofstream(folder_ / "other.yaml") << "instrument: {length_m: 0.6}\n";
  EXPECT_FALSE(IsArmScenario(folder_ / "other.yaml"));
}

TEST_F(ArmScenarioTest, AnOffsetIsBetweenEncodersAndSeenJoints) {
  const Recording plain = Record(""),
                  off = Record("effects: {joint_offset: {offset: [0.02, 0.0, 0.0]}}\n");
  const double before = MeanDifference(*plain.joints_seen0, *plain.joints0, 0);
  EXPECT_NEAR(MeanDifference(*off.joints_seen0, *off.joints0, 0) - before, 0.02, 1e-3);
  EXPECT_NEAR(MeanDifference(*off.joints_seen0, *off.joints0, 1),
              MeanDifference(*plain.joints_seen0, *plain.joints0, 1), 1e-3);
}

/// A first-order lag stays behind by the rate times its time.
TEST_F(ArmScenarioTest, ALagStaysBehindByTheRate) {
  const Recording r = Record("effects: {servo_lag: {time_s: [0.0, 0.04, 0.0]}}\n");
  double products = 0.0, squares = 0.0;
  const auto& command = r.joints_command0->q;
  for (std::size_t k = 1; k + 1 < command.size(); ++k) {
    const double rate =
        25.0 * (command.at(k + 1).value[1] - command.at(k - 1).value[1]);  // over 0.04 s
    products += rate * (command.at(k).value[1] - r.joints0->q.at(k).value[1]);
    squares += rate * rate;
  }
  EXPECT_NEAR(products / squares, 0.04, 0.004);
}

TEST_F(ArmScenarioTest, KeepsTheSensorsThatItNames) {
  const Recording r = Record("sensors: [joints0, torque0]\n");
  EXPECT_TRUE(r.joints0 && r.torque0);
  EXPECT_FALSE(r.joints_command0 || r.joints_seen0 || r.pose0);
}

TEST_F(ArmScenarioTest, RefusesWhatItCannotDo) {
  EXPECT_THAT(Complaint("effects: {joint_ofset: {offset: [0, 0, 0]}}\n"),
              HasSubstr("'joint_ofset', which is no effect"));
  EXPECT_THAT(Complaint("effects: {joint_offset: {offset: [0, 0]}}\n"),
              HasSubstr("scenario.yaml:2"));
  EXPECT_THAT(Complaint("sensors: [joints1]\n"), HasSubstr("found joints1"));
  EXPECT_THAT(Complaint("motion: {seconds: 1e5, rate_hz: 1000}\n"), HasSubstr("1e+08 rows"));
  EXPECT_THAT(Complaint("effects: {payload: {place: nose, mass_kg: 1}}\n"), HasSubstr("'nose'"));
  EXPECT_THAT(Complaint("effects: {payload: {link: 4, mass_kg: 1}}\n"), HasSubstr("1 to 3"));
  EXPECT_THAT(Complaint("effects: {joint_backlash: {width: [-1, 0, 0]}}\n"),
              HasSubstr("0 or more"));
  EXPECT_THAT(Complaint("speed: 3\n"), HasSubstr("speed"));
  std::ofstream(folder_ / "map.yaml") << "arm: {kind: planar}\n";
  ReadLog log;
  try {
    ReadArmScenario(folder_ / "map.yaml", log);
    ADD_FAILURE() << "not refused";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("map.yaml:1: arm: found no file of an arm"));
  }
  Arm light = SmallArm();
  light.links.clear();
  WriteArm(folder_ / "arm.yaml", light);
  EXPECT_THAT(Complaint(""), HasSubstr("no masses"));
}

}  // namespace
}  // namespace flextip::simulation
