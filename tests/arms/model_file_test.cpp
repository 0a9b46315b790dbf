// An arm's model.yaml: what is refused, with the line, or the parameter that does not fit the arm.
#include "arms/diagnose/model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arms/diagnose/predict.h"
#include "core/error.h"
#include "recording/text/text.h"
#include "tests/arms/made_arm.h"

namespace flextip::arms {
namespace {

using testing::HasSubstr;

class ArmModelFile : public testing::Test {
 protected:
  ~ArmModelFile() override { std::filesystem::remove(file_); }

  ArmModel Read(const std::string& sections) {
    WriteTextFile(file_, "format: flextip-arm-model\nversion: 1\n" + sections);
    return ReadArmModel(file_);
  }
  std::string Refusal(const std::string& sections) {
    try {
      Read(sections);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  /// What a prediction by the model says on a recording with efforts.
  std::string RefusalByTheArm(const std::string& sections, const Arm& arm = SixJoints()) {
    Recording recording = ArmRecording(arm);
    recording.joints0 = SmoothMotion(*recording.arm, 200, 50.0, 3);
    recording.joints_seen0 = recording.joints0;
    recording.torque0 = TorqueStream{"", 50.0, {JointType::kRevolute}, {0.01}, {}};
    for (const auto& sample : recording.joints0->q)
      recording.torque0->tau.push_back({sample.t_ns, Eigen::VectorXd::Constant(1, 0.5)});
    recording.arm->payload_places = {{"end", 3, {0.0, 0.0, 0.1}}};
    try {
      Predict(ArmData(recording, "made"), Read(sections));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

 private:
  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() /
      (std::string("flextip_arm_model_") +
       testing::UnitTest::GetInstance()->current_test_info()->name() + ".yaml");
};

TEST_F(ArmModelFile, RefusesWhatIsUnknown) {
  EXPECT_EQ(Refusal("effects: {joint_offset: {offset: [1, 2]}}\nnuisances: {masses: {a: 1}}\n"),
            "");
  EXPECT_THAT(Refusal("effects:\n  joint_ofset: {offset: [1, 2]}\n"),
              HasSubstr(".yaml:4: effects.joint_ofset: found \"joint_ofset\", which is unknown"));
  EXPECT_THAT(Refusal("effects: {masses: {a: 1}}\n"), HasSubstr("unknown"));
  EXPECT_THAT(Refusal("nuisances: {joint_offset: {offset: [1, 2]}}\n"), HasSubstr("unknown"));
  EXPECT_THAT(Refusal("efects: {}\n"), HasSubstr("efects"));
  EXPECT_THAT(Refusal("effects: {payload: {mass_kg: 1, \"a b\": 1}}\n"),
              HasSubstr("letters, digits and _"));
}

TEST_F(ArmModelFile, RefusesListsOfAnotherArm) {
  const std::string zeros = "[0, 0, 0, 0, 0, 0]";
  EXPECT_EQ(RefusalByTheArm("effects: {joint_offset: {offset: " + zeros + "}}\n"), "");
  EXPECT_THAT(RefusalByTheArm("effects: {joint_offset: {offset: [0, 0]}}\n"),
              HasSubstr("joint_offset.offset: found 2 numbers, expected 6 for this arm"));
  EXPECT_THAT(RefusalByTheArm("effects: {joint_backlash: {width: [0.1]}}\n"),
              HasSubstr("joint_backlash.width: found 1 numbers, expected 6"));
  std::string drag = "0";
  for (int i = 1; i < 30; ++i) drag += ", 0";
  EXPECT_THAT(RefusalByTheArm("effects: {joint_backlash: {width: " + zeros + ", drag: [" + drag +
                              "], window: [0.1]}}\n"),
              HasSubstr("joint_backlash.window: found 1 numbers, expected 6"));
}

TEST_F(ArmModelFile, RefusesAPayloadWithoutItsPlace) {
  const Arm arm = ThreeJointsWithMasses();
  EXPECT_EQ(RefusalByTheArm("effects: {payload: {mass_kg: 0.1, place: 1}}\n", arm), "");
  EXPECT_THAT(RefusalByTheArm("effects: {payload: {mass_kg: 0.1, place: []}}\n", arm),
              HasSubstr("payload.place: found 0 numbers, expected 1"));
}

}  // namespace
}  // namespace flextip::arms
