// Bags that other programs wrote (testdata/bags): their numbers come back as they went in.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "exchange/bags/bags.h"
#include "exchange/bags/topics.h"
#include "exchange/mapping_file.h"
#include "recording/frames/frames.h"
#include "recording/recording_reader.h"
#include "tests/exchange/tables.h"
#include "tests/recording/sample_recording.h"

namespace flextip::exchange {
namespace {

using flextip::test_support::ReadText;
using flextip::test_support::TemporaryFolder;
using flextip::test_support::WriteText;
using test_support::PlanWithSettings;
using test_support::Refusal;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kCount = 40;
constexpr TimeNs kStart = 1'700'000'000'123'456'789, kStep = 20'000'000;

std::filesystem::path BagFile(const std::string& name) {
  return std::filesystem::path(FLEXTIP_SOURCE_DIR) / "testdata/bags" / name;
}

// The motion that the writers' scripts state, too.
Eigen::Vector3d Place(int k, double offset) {
  return {0.1 + 0.01 * std::sin(0.3 * k) + offset, -0.02 * k / kCount, 0.05 * std::cos(0.2 * k)};
}
Eigen::Quaterniond Turn(int k) { return {std::cos(0.01 * k), 0.0, 0.0, std::sin(0.01 * k)}; }

class BagImport : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    try {
      OpenBag(BagFile(GetParam()));
    } catch (const InputError& error) {
      if (std::string(error.what()).find("was built without") == std::string::npos) throw;
      GTEST_SKIP() << error.what();
    }
  }
  ImportPlan Plan() const {
    ImportPlan plan = PlanWithSettings();
    plan.bags = {BagFile(GetParam())};
    plan.streams["wrist0"].topic = "/PSM1/measured_cp";
    return plan;
  }
  TemporaryFolder folder_;
};

TEST_P(BagImport, NumbersComeBackToTheBit) {
  const Imported imported = Import(Plan());
  const Recording& r = imported.recording;
  ASSERT_TRUE(r.wrist0 && r.command0 && r.em0 && r.load0);
  ASSERT_EQ(r.wrist0->samples.size(), static_cast<std::size_t>(kCount));
  for (int k = 0; k < kCount; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const TimeNs t_ns = kStart + k * kStep;
    EXPECT_EQ(r.wrist0->samples[i].t_ns, t_ns);
    EXPECT_LE((r.wrist0->samples[i].value.p_RW - Place(k, 0.0)).norm(), 1e-15);
    EXPECT_LE((r.wrist0->samples[i].value.q_RW->coeffs() - Turn(k).coeffs()).norm(), 1e-15);
    EXPECT_LE((r.command0->p_RW[i].value - Place(k + 1, 0.0)).norm(), 1e-15);
    EXPECT_EQ(r.em0->samples[i].t_ns, t_ns + 7'000'000);
    EXPECT_LE((r.em0->samples[i].value.p_RS - Place(k, -0.2)).norm(), 1e-15);
    EXPECT_LE(
        (r.load0->f_tip_N[i].value - Eigen::Vector3d(0.1 * k, -0.2, 0.3 * std::sin(k))).norm(),
        1e-15);
  }
  EXPECT_THAT(imported.log.assumed.at("wrist0.frame"), HasSubstr("PSM1_base"));
  EXPECT_THAT(imported.log.assumed.at("em0.topic"), HasSubstr("/aurora/tool"));
  EXPECT_THAT(imported.log.warnings, Contains(HasSubstr("/PSM2/measured_cp")));
}

TEST_P(BagImport, JointsGoIntoAFolderOfTheirOwn) {
  ImportPlan plan = Plan();
  plan.streams["torque0"].topic = "/PSM1/measured_js";
  const Imported imported = Import(plan);
  WriteImported(folder_ / "out", imported);
  const std::string joints = ReadText(folder_ / "out/joints0/data.csv");
  EXPECT_THAT(joints, testing::StartsWith("#timestamp [ns],q1 [rad],q2 [rad],q3 [m]\n"
                                          "1700000000123456789,0,-0,0.1\n"
                                          "1700000000143456789,0.01,-0.02,0.101\n"));
  EXPECT_THAT(ReadText(folder_ / "out/joints0/sensor.yaml"),
              HasSubstr("joints yaw, pitch, insertion"));
  EXPECT_THAT(ReadText(folder_ / "out/torque0/data.csv"),
              testing::StartsWith("#timestamp [ns],tau1 [Nm],tau2 [Nm],tau3 [N]\n"
                                  "1700000000123456789,0.5,0,1\n"
                                  "1700000000143456789,0.5,0.25,1\n"));
  ASSERT_EQ(imported.others.size(), 2U);
  EXPECT_EQ(imported.others[0].name, "joints0");
  EXPECT_EQ(imported.others[0].samples, static_cast<std::size_t>(kCount));
}

const std::filesystem::path kArm =
    std::filesystem::path(FLEXTIP_SOURCE_DIR) / "testdata/arms/small/arm.yaml";

TEST_P(BagImport, AnArmsFileComesAlongAndSaysWhichJointsSlide) {
  ImportPlan plan = Plan();
  plan.arm = kArm;
  WriteImported(folder_ / "out", Import(plan));
  const Recording read = ReadRecording(folder_ / "out").recording;
  ASSERT_TRUE(read.arm && read.joints0 && read.wrist0);
  EXPECT_EQ(read.arm->Size(), 3);
  EXPECT_THAT(read.joints0->types,
              ElementsAre(JointType::kRevolute, JointType::kRevolute, JointType::kPrismatic));
  EXPECT_EQ(read.joints0->q.size(), std::size_t(kCount));
  ImportPlan again;
  ReadMapping(folder_ / "out/import.yaml", again);
  EXPECT_EQ(again.arm, std::filesystem::absolute(kArm).lexically_normal());
}

TEST_P(BagImport, AnArmAloneNeedsNoInstrument) {
  ImportPlan plan;
  plan.bags = {BagFile(GetParam())};
  plan.streams["joints0"].topic = "/PSM1/measured_js";
  plan.arm = kArm;
  const Imported imported = Import(plan);
  WriteImported(folder_ / "out", imported);
  const Recording read = ReadRecording(folder_ / "out").recording;
  EXPECT_FALSE(read.has_shaft);
  EXPECT_FALSE(read.wrist0 || read.em0 || read.cam0);
  EXPECT_TRUE(read.arm && read.joints0);
  EXPECT_THAT(imported.log.assumed.at("instrument"), HasSubstr("the arm's joints alone"));
}

TEST_P(BagImport, AnArmWithOtherJointsIsRefused) {
  WriteText(folder_ / "two.yaml",
            "format: flextip-arm\nversion: 1\nconvention: dh\njoints:\n"
            "  - {type: revolute, a_m: 0.1, alpha_rad: 0, d_m: 0, theta_rad: 0}\n"
            "  - {type: revolute, a_m: 0.1, alpha_rad: 0, d_m: 0, theta_rad: 0}\n");
  ImportPlan plan = Plan();
  plan.arm = folder_ / "two.yaml";
  EXPECT_THAT(Refusal(plan),
              testing::AllOf(HasSubstr("joints0 has 3 joints (yaw, pitch, insertion)"),
                             HasSubstr("has 2")));
}

TEST_P(BagImport, PicturesComeBackPixelByPixel) {
  WriteImported(folder_ / "out", Import(Plan()));
  const auto read = ReadRecording(folder_ / "out");
  ASSERT_TRUE(read.recording.cam0 && read.recording.cam1);
  const CameraCalibration& left = read.recording.cam0->calibration;
  EXPECT_FALSE(read.recording.cam0->has_T_RC);
  EXPECT_EQ(left.fu_px, 7.0);
  EXPECT_EQ(left.cv_px, 2.5);
  EXPECT_EQ(left.distortion, Distortion::kRadialTangential);
  EXPECT_THAT(left.distortion_coefficients, ElementsAre(0.1, -0.2, 0.001, 0.002));
  EXPECT_EQ(read.recording.cam1->calibration.distortion, Distortion::kEquidistant);
  EXPECT_NEAR(left.rate_hz, 5.0, 1e-9);
  const auto& frames = read.recording.cam0->filenames;
  ASSERT_EQ(frames.size(), 4U);
  for (int n = 0; n < 4; ++n) {
    const auto& frame = frames[static_cast<std::size_t>(n)];
    EXPECT_EQ(frame.t_ns, kStart + 10 * n * kStep);
    const Image image = ReadImageFile(folder_ / "out/cam0/data" / frame.value);
    ASSERT_EQ(image.width_px, 8);
    for (int y = 0; y < 6; ++y) {
      for (int x = 0; x < 8; ++x) {
        for (int c = 0; c < 3; ++c) {  // red first in the message, blue first here
          EXPECT_EQ(image.Row(y)[3 * x + 2 - c], (3 * x + 5 * y + 7 * c + 10 * n) % 256);
        }
      }
    }
  }
  EXPECT_EQ(ReadText(folder_ / "out/cam1/data" / read.recording.cam1->filenames[0].value),
            ReadText(BagFile("grey.png")));
}

TEST_P(BagImport, TheMappingMakesItAgain) {
  WriteImported(folder_ / "first", Import(Plan()));
  ImportPlan again;
  ReadMapping(folder_ / "first/import.yaml", again);
  WriteImported(folder_ / "second", Import(again));
  for (const char* file : {"import.yaml", "wrist0/data.csv", "em0/sensor.yaml", "cam0/data.csv",
                           "cam1/sensor.yaml", "joints0/sensor.yaml"}) {
    EXPECT_EQ(ReadText(folder_ / "first" / file), ReadText(folder_ / "second" / file)) << file;
  }
}

TEST_P(BagImport, AWristOfSeveralArmsHasToBeTold) {
  ImportPlan plan = Plan();
  plan.streams.clear();
  EXPECT_THAT(Refusal(plan), HasSubstr("wrist0 may be /PSM1/measured_cp, /PSM2/measured_cp"));
  plan.streams["wrist0"].topic = "/PSM3/measured_cp";
  EXPECT_THAT(Refusal(plan), HasSubstr("wrist0: found no topic /PSM3/measured_cp in the bag"));
  plan.streams["wrist0"].topic = "/ft_sensor/wrench";
  EXPECT_THAT(Refusal(plan), HasSubstr("is of type geometry_msgs/WrenchStamped"));
}

TEST_P(BagImport, ATornFileIsReadAsFarAsItGoesOrRefused) {
  const std::string whole = ReadText(BagFile(GetParam()));
  ImportPlan plan = Plan();
  plan.bags = {folder_ / "torn"};
  // Chunks of the plain file hold fewer samples.
  const std::size_t parts = GetParam() == "ros2_plain.mcap" ? 3 : 2;
  WriteText(folder_ / "torn", whole.substr(0, whole.size() * parts / 4));
  if (GetParam().ends_with(".bag")) {
    EXPECT_THAT(Refusal(plan), HasSubstr("rosbag reindex"));
    return;
  }
  const Imported imported = Import(plan);
  const std::size_t samples = imported.recording.wrist0->samples.size();
  EXPECT_GT(samples, 5U);
  EXPECT_LT(samples, static_cast<std::size_t>(kCount));
  EXPECT_THAT(imported.log.warnings, Contains(HasSubstr("ends in the midst of a record")));
}

INSTANTIATE_TEST_SUITE_P(Files, BagImport,
                         testing::Values("ros1_lz4.bag", "ros2_lz4.mcap", "ros2_plain.mcap",
                                         "ros2_zstd.mcap"),
                         [](const auto& file) {
                           return file.param.substr(0, file.param.find('.'));
                         });

TEST(Bags, OfSeveralFilesAreReadAsOne) {
  const Bags bags({BagFile("ros2_plain.mcap"), BagFile("ros2_plain.mcap")});
  ASSERT_NE(bags.Find("/aurora/tool"), nullptr);
  EXPECT_EQ(bags.Find("/aurora/tool")->messages, 2 * kCount);
  EXPECT_EQ(bags.Find("/aurora/tool")->type, "geometry_msgs/TransformStamped");
}

TEST(Bags, RefuseOtherFiles) {
  const TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) {
    WriteText(folder / "a.bag", text);
    try {
      OpenBag(folder / "a.bag");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("opened");
  };
  EXPECT_THAT(refusal("time,x\n"), HasSubstr("is no bag"));
  EXPECT_THAT(refusal("#ROSBAG V1.2\n..."), HasSubstr("another version"));
  EXPECT_THAT(refusal("SQLite format 3"), HasSubstr("ros2 bag convert"));
  std::string damaged = ReadText(BagFile("ros2_plain.mcap"));
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 1);
  EXPECT_THAT(refusal(damaged), HasSubstr("a chunk's checksum is wrong"));
}

TEST(Topics, FollowTheArmOfTheWrist) {
  const auto topic = [](const char* name, const char* type) {
    return BagTopic{name, type, WireFormat::kRos1, 5};
  };
  const std::vector<BagTopic> topics{topic("/PSM1/measured_cp", "geometry_msgs/PoseStamped"),
                                     topic("/PSM1/local/measured_cp", "geometry_msgs/PoseStamped"),
                                     topic("/PSM1/setpoint_cp", "geometry_msgs/PoseStamped"),
                                     topic("/PSM1/servo_cp", "geometry_msgs/PoseStamped"),
                                     topic("/PSM1/jaw/measured_js", "sensor_msgs/JointState"),
                                     topic("/PSM1/measured_cf", "geometry_msgs/WrenchStamped"),
                                     topic("/PSM2/setpoint_cp", "geometry_msgs/PoseStamped"),
                                     topic("/em/left", "geometry_msgs/PoseStamped"),
                                     topic("/em/right", "geometry_msgs/PoseStamped")};
  ImportPlan plan;
  ImportLog log;
  ChooseTopics(topics, plan, log);
  EXPECT_EQ(plan.streams.at("wrist0").topic, "/PSM1/measured_cp");
  EXPECT_EQ(plan.streams.at("command0").topic, "/PSM1/setpoint_cp");
  EXPECT_FALSE(plan.streams.contains("joints0"));
  EXPECT_FALSE(plan.streams.contains("load0"));
  EXPECT_FALSE(plan.streams.contains("em0"));
  EXPECT_THAT(log.warnings, Contains(HasSubstr("em0 may be /em/left, /em/right: none is taken")));
}

}  // namespace
}  // namespace flextip::exchange
