// Arms and their streams: round trips, and what is refused with file and line.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/error.h"
#include "recording/arm/arm_file.h"
#include "recording/recording_reader.h"
#include "recording/recording_writer.h"
#include "recording/text/text.h"

namespace flextip {
namespace {

using testing::HasSubstr;

namespace fs = std::filesystem;

constexpr const char* kArmText =
    "format: flextip-arm\nversion: 1\nconvention: modified-dh\njoints:\n"
    "  - {type: revolute, a_m: 0, alpha_rad: 1.5, d_m: 0, theta_rad: 1.5}\n"
    "  - {type: prismatic, a_m: 0.1, alpha_rad: 0, d_m: -0.4, theta_rad: 0}\n";

class ArmFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::temp_directory_path() / (std::string("flextip_arm_") +
                                     testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    Write("arm.yaml", kArmText);
    Write("recording.yaml", "format: flextip-recording\nversion: 1\ngravity_m_s2: [0, 0, -9.81]\n");
    Write("joints0/sensor.yaml",
          "sensor_type: joints\nrate_hz: 10\narm: ../arm.yaml\njoint_noise: [1e-4, 1e-5]\n");
    Write("joints0/data.csv", "#timestamp [ns],q1 [rad],q2 [m]\n1,0.1,0.2\n2,0.3,0.4\n");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void Write(const std::string& name, const std::string& text) {
    WriteTextFile(folder_ / name, text);
  }
  std::string Refusal() {
    try {
      ReadRecording(folder_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  fs::path folder_;
};

TEST_F(ArmFiles, AreReadWithoutAShaft) {
  const ReadResult read = ReadRecording(folder_);
  EXPECT_TRUE(read.warnings.empty());
  EXPECT_FALSE(read.recording.has_shaft);
  ASSERT_TRUE(read.recording.HasArm());
  EXPECT_EQ(read.recording.arm->Size(), 2);
  EXPECT_EQ(read.recording.joints0->q.size(), 2U);
  EXPECT_EQ(read.recording.joints0->q[1].value, Eigen::Vector2d(0.3, 0.4));
}

TEST_F(ArmFiles, WrittenThenReadGiveTheSame) {
  Recording recording = ReadRecording(folder_).recording;
  recording.arm->T_LK = Pose{Eigen::Matrix3d::Identity(), {0.1, 0.2, 0.3}};
  recording.arm->links = {{1.0, {0.1, 0, 0}}, {2.0, {0, 0.2, 0}}};
  recording.arm->payload_places = {{"end", 2, {0.0, 0.0, 0.1}},
                                   {"bar", 0, {}, 1, {0.04, 0.18}, 0.165}};
  recording.joints_seen0 = recording.joints0;
  recording.torque0 = TorqueStream{"", 10, {JointType::kRevolute}, {0.01}, {}};
  recording.torque0->tau = {{1, Eigen::VectorXd::Constant(1, 0.5)}};
  recording.pose0 = PoseStream{"", 10, 1e-4, 1e-3, 0.1, 0.2, {}};
  recording.pose0->samples = {{1, {{1, 2, 3}, Eigen::Quaterniond::Identity()}},
                              {2, {{1, 2, 4}, {}}}};
  const fs::path copy = folder_ / "copy";
  WriteRecording(copy, recording);
  const Recording again = ReadRecording(copy).recording;
  EXPECT_EQ(again.joints_seen0->q, recording.joints_seen0->q);
  EXPECT_EQ(again.torque0->tau, recording.torque0->tau);
  EXPECT_EQ(again.torque0->types.size(), 1U);
  EXPECT_EQ(again.pose0->samples[0].value.p_RK, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(again.pose0->samples[1].value.q_RK);
  EXPECT_EQ(again.pose0->registration_noise_m, 0.2);
  EXPECT_EQ(again.arm->T_LK->p, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(again.arm->links[1].mass_kg, 2.0);
  EXPECT_EQ(again.arm->payload_places[1].keeps_orientation_of, 1);
  EXPECT_EQ(again.arm->payload_places[1].bar_m, Eigen::Vector2d(0.04, 0.18));
  EXPECT_EQ(again.arm->joints[1].before.p, recording.arm->joints[1].before.p);
}

TEST_F(ArmFiles, AreRefusedWithFileAndLine) {
  Write("joints0/data.csv", "#timestamp [ns],q1 [rad],q2 [rad]\n1,0.1,0.2\n");
  EXPECT_THAT(Refusal(), HasSubstr("q2 [m]"));
  Write("joints0/data.csv", "#timestamp [ns],q1 [rad],q2 [m]\n1,0.1,nan\n");
  EXPECT_THAT(Refusal(), HasSubstr("data.csv:2"));
  Write("joints0/data.csv", "#timestamp [ns],q1 [rad],q2 [m]\n2,0.1,0.1\n1,0.1,0.1\n");
  EXPECT_THAT(Refusal(), HasSubstr("data.csv:3"));
  Write("joints0/data.csv", "#timestamp [ns],q1 [rad],q2 [m]\n1,0.1,0.1\n");
  Write("joints0/sensor.yaml", "rate_hz: 10\narm: ../arm.yaml\njoint_noise: [1e-4]\n");
  EXPECT_THAT(Refusal(), HasSubstr("found 1 numbers, expected 2"));
  Write("joints0/sensor.yaml", "rate_hz: 10\narm: ../none.yaml\njoint_noise: [1e-4, 1e-4]\n");
  EXPECT_THAT(Refusal(), HasSubstr("sensor.yaml:2"));
}

TEST_F(ArmFiles, AnArmsFileIsRefusedWithItsLine) {
  Write("arm.yaml", std::string(kArmText) + "links: [{mass_kg: 1, com_m: [0, 0, 0]}]\n");
  EXPECT_THAT(Refusal(), HasSubstr("found 1 links, expected 2"));
  Write("arm.yaml", std::string(kArmText) + "payload_places: [{name: a, link: 3, p_m: [0,0,0]}]\n");
  EXPECT_THAT(Refusal(), HasSubstr("found 3, expected 1 to 2"));
  Write("arm.yaml", "format: flextip-arm\nversion: 2\nconvention: dh\njoints: []\n");
  EXPECT_THAT(Refusal(), HasSubstr("arm.yaml:2"));
}

TEST_F(ArmFiles, AShaftsSensorsNeedTheShaft) {
  Write("em0/sensor.yaml", "rate_hz: 10\n");
  EXPECT_THAT(Refusal(), HasSubstr("instrument"));
}

TEST_F(ArmFiles, AUrdfIsAnArm) {
  Write("arm.urdf", R"(<?xml version="1.0"?>
<robot name="two"> <!-- a comment -->
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 0.1"/><mass value="1.5"/></inertial></link>
  <link name="hand"><inertial><mass value="0.5"/></inertial></link>
  <joint name="lift" type="prismatic"><parent link="upper"/><child link="hand"/>
    <origin xyz="0.3 0 0" rpy="0 0 0"/><axis xyz="0 0 1"/></joint>
  <joint name="turn" type="revolute"><parent link="base"/><child link="upper"/>
    <origin xyz="0 0 0.5" rpy="0 0 0"/><axis xyz="0 1 0"/></joint>
</robot>)");
  ReadLog log;
  const Arm arm = ReadArm(folder_ / "arm.urdf", log);
  ASSERT_EQ(arm.Size(), 2);
  EXPECT_EQ(arm.joints[0].name, "turn");
  EXPECT_EQ(arm.joints[0].axis, Eigen::Vector3d::UnitY());
  EXPECT_EQ(arm.joints[1].type, JointType::kPrismatic);
  EXPECT_EQ(arm.joints[1].before.p, Eigen::Vector3d(0.3, 0, 0));
  EXPECT_EQ(arm.links[0].com_m, Eigen::Vector3d(0, 0, 0.1));
  Write("arm.urdf", "<robot name='x'>\n<joint name='a' type='floating'>\n</joint></robot>");
  EXPECT_THROW(ReadArm(folder_ / "arm.urdf", log), InputError);
  Write("arm.urdf", "<robot><joint");
  EXPECT_THROW(ReadArm(folder_ / "arm.urdf", log), InputError);
}

/// A URDF of joints one behind the other, a line each, whose first link has this mass.
std::string ChainOf(int joints, const std::string& mass = "1") {
  std::string text =
      "<robot><link name='1'><inertial><mass value='" + mass + "'/></inertial></link>\n";
  for (int i = 0; i < joints; ++i) {
    text += fmt::format("<joint name='j' type='{}'><parent link='{}'/><child link='{}'/></joint>\n",
                        i < 2 ? "revolute" : "fixed", i, i + 1);
  }
  return text + "</robot>";
}

TEST_F(ArmFiles, AUrdfIsRefusedWithItsLine) {
  const auto refusal = [&](const std::string& text) -> std::string {
    Write("arm.urdf", text);
    ReadLog log;
    try {
      ReadArm(folder_ / "arm.urdf", log);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(ChainOf(1000)), "");
  EXPECT_THAT(refusal(ChainOf(1001)), HasSubstr("arm.urdf:1002: found more than 1000 joints"));
  EXPECT_THAT(refusal(ChainOf(2, "-1")), HasSubstr("arm.urdf:1: link 1: found a mass of -1 kg"));
  EXPECT_THAT(refusal(ChainOf(2, "2e5")), HasSubstr("expected 0 to 100000"));
}

}  // namespace
}  // namespace flextip
