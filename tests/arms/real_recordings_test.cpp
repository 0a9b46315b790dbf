// Real arms: what is known of them is found, and nothing that they do not hold.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "arms/diagnose/diagnose.h"
#include "arms/diagnose/predict.h"
#include "arms/feed_forward/joint_model.h"
#include "arms/feed_forward/sampled_path.h"
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

// Its offsets drift, and what is left is far beyond the noise: that alone makes it no unknown.
TEST_F(RealArms, AWristWhoseOffsetsDriftIsStillNamed) {
  const ArmResult result = Diagnose({Read("seen_joints_wrist_one_joint_c")});
  EXPECT_THAT(result.answer.verdict, Contains("joint_offset"));
  EXPECT_THAT(result.answer.verdict, Contains("joint_backlash"));
}

/// Rows of a part of the recording.
Recording PartOf(Recording recording, double from, double to) {
  const auto cut = [&](auto& samples) {
    const auto rows = double(samples.size());
    samples.erase(samples.begin() + long(to * rows), samples.end());
    samples.erase(samples.begin(), samples.begin() + long(from * rows));
  };
  cut(recording.joints0->q);
  cut(recording.joints_command0->q);
  if (recording.torque0) cut(recording.torque0->tau);
  return recording;
}

/// The inversion on a real arm: for where it went, the feed-forward must give the commands that it
/// was given, on the half of the recording that nothing was fitted to. Root mean square (rad) of
/// what a joint is off its command, and of what the feed-forward's command is.
struct OffCommand {
  double joint = 0.0, feed_forward = 0.0;
};
std::vector<OffCommand> OffCommands(const Recording& whole, int joints) {
  const ArmData first(PartOf(whole, 0.0, 0.5), "first"), second(PartOf(whole, 0.5, 1.0), "second");
  const CommandModel model = CommandModelOf(first.arm, Diagnose({first}).model, first.gravity_m_s2);
  const SampledPath went(second.joints), given(second.command);
  const PathCommands commands = CommandsFor(went, model.joints);
  std::vector<OffCommand> off(joints);
  int rows = 0;
  for (Eigen::Index k = 0; k < commands.q.rows(); ++k) {
    const double t_s = second.joints.t_s[k];
    if (t_s < 1.0 || t_s > second.joints.t_s[commands.q.rows() - 1] - 1.0) continue;
    ++rows;
    for (int i = 0; i < joints; ++i) {
      const double asked = given.JointsAt(t_s)[i];
      off[i].joint += std::pow(second.joints.values(k, i) - asked, 2);
      off[i].feed_forward += std::pow(commands.q(k, i) - asked, 2);
    }
  }
  for (int i = 0; i < joints; ++i) {
    off[i] = {std::sqrt(off[i].joint / rows), std::sqrt(off[i].feed_forward / rows)};
    fmt::print("q{}: {:.2f} -> {:.2f} mrad\n", i + 1, 1e3 * off[i].joint,
               1e3 * off[i].feed_forward);
  }
  return off;
}

TEST_F(RealArms, TheFeedForwardGivesTheCommandsThatAnArmWasGiven) {
  const auto off = OffCommands(ReadRecording(kArms / "servo_b_arm1_motion1").recording, 2);
  for (const OffCommand& joint : off) {
    EXPECT_GT(joint.joint, 0.035);
    EXPECT_LT(joint.feed_forward, 0.04 * joint.joint);
  }
}

// Takes eight seconds.
TEST_F(RealArms, DISABLED_TheFeedForwardGivesTheCommandsOfAnotherArm) {
  const auto off = OffCommands(ReadRecording(kArms / "servo_a_motion_01").recording, 2);
  EXPECT_LT(off[0].feed_forward, 0.04 * off[0].joint);
  EXPECT_LT(off[1].feed_forward, 0.2 * off[1].joint);
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
