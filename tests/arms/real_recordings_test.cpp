// Real arms: what is known of them is found, and nothing that they do not hold.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "arms/diagnose/diagnose.h"
#include "arms/diagnose/predict.h"
#include "recording/recording_reader.h"

namespace flextip::arms {
namespace {

using testing::Contains;
using testing::Not;

const std::filesystem::path kArms = FLEXTIP_SHARED_DIR "/data/arms";

class RealArms : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::is_directory(kArms)) GTEST_SKIP() << "no " << kArms;
  }
  static ArmData Read(const std::string& name) {
    return {ReadRecording(kArms / name).recording, name};
  }
};

TEST_F(RealArms, ServoLagAndDroopAreFoundWhereEffortsAreThere) {
  const ArmResult result = Diagnose({Read("servo_a_motion_01")});
  EXPECT_THAT(result.answer.verdict, Contains("servo_lag"));
  EXPECT_THAT(result.answer.verdict, Contains("servo_droop"));
  EXPECT_LT(result.answer.extended.heldout_rms.at("joints0_q1_rad"), 0.3e-3);
  EXPECT_LT(result.answer.extended.heldout_rms.at("joints0_q2_rad"), 0.15e-3);
}

TEST_F(RealArms, BareArmCarriesNoPayload) {
  const ArmResult result = Diagnose({Read("load_bare_motion_one"), Read("load_bare_motion_two")});
  EXPECT_THAT(result.answer.verdict, Not(Contains("payload")));
  for (const Change& change : result.changes) EXPECT_NE(change.effect, "payload");
}

TEST_F(RealArms, PlayAndOffsetsOfTheWristAreFound) {
  const ArmResult result = Diagnose({Read("seen_joints_wrist_one_joint_a")});
  EXPECT_THAT(result.answer.verdict, Contains("joint_offset"));
  EXPECT_THAT(result.answer.verdict, Contains("joint_backlash"));
  EXPECT_LT(result.answer.gain.tip_error_ratio, 0.1);
}

}  // namespace
}  // namespace flextip::arms
