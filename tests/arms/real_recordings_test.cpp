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

/// Seen joints between two parts of the recording's time.
ArmData SeenBetween(Recording recording, double from, double to, const std::string& name) {
  const TimeNs begin = recording.joints_command0->q.front().t_ns;
  const double whole = double(recording.joints_command0->q.back().t_ns - begin);
  const auto cut = [&](auto& samples) {
    std::erase_if(samples, [&](const auto& sample) {
      const double at = double(sample.t_ns - begin) / whole;
      return at < from || at > to;
    });
  };
  cut(recording.joints_command0->q);
  cut(recording.joints_seen0->q);
  return {recording, name};
}

/// Tip (m) with the model of `fitted` over that of the arm's file, on `other`.
double TipRatio(const std::vector<ArmData>& fitted, const ArmData& other) {
  const ArmPrediction prediction = Predict(other, Diagnose(fitted).model);
  fmt::print("{}: {:.2f} -> {:.2f} mm, joints 5 and 6 {:.0f}, {:.0f} -> {:.0f}, {:.0f} mrad\n",
             other.name, 1e3 * prediction.base_tip_rms_m, 1e3 * prediction.extended_tip_rms_m,
             1e3 * prediction.base_rms.at("joints_seen0_q5_rad"),
             1e3 * prediction.base_rms.at("joints_seen0_q6_rad"),
             1e3 * prediction.extended_rms.at("joints_seen0_q5_rad"),
             1e3 * prediction.extended_rms.at("joints_seen0_q6_rad"));
  return prediction.tip_ratio;
}

// Takes a minute. Its springs look like a scale, and its camera's errors like one of joint 3.
TEST_F(RealArms, DISABLED_AWristHasOffsetsAndPlaysAndNoScale) {
  std::vector<ArmData> all{Read("seen_joints_random_motion")};
  for (const char* part : {"a", "b", "c"})
    all.push_back(Read(std::string("seen_joints_wrist_one_joint_") + part));
  const ArmResult result = Diagnose(all);
  EXPECT_THAT(result.answer.verdict, Contains("joint_offset"));
  EXPECT_THAT(result.answer.verdict, Contains("joint_backlash"));
  EXPECT_THAT(result.answer.verdict, Not(Contains("joint_scale")));
  EXPECT_LT(result.answer.extended.tip_prediction_rms_m, 0.7e-3);
}

// Takes twenty seconds.
TEST_F(RealArms, DISABLED_ServosArePredictedOnTheHalfThatIsNotFitted) {
  for (const char* name : {"servo_a_motion_01", "servo_b_arm1_motion1"}) {
    const Recording whole = ReadRecording(kArms / name).recording;
    const ArmData first(PartOf(whole, 0.0, 0.5), name), second(PartOf(whole, 0.5, 1.0), name);
    for (const auto& [fitted, other] : {std::pair(first, second), std::pair(second, first)}) {
      const ArmPrediction prediction = Predict(other, Diagnose({fitted}).model);
      for (const char* joint : {"joints0_q1_rad", "joints0_q2_rad"}) {
        const double before = prediction.base_rms.at(joint),
                     after = prediction.extended_rms.at(joint);
        fmt::print("{} {}: {:.1f} -> {:.3f} mrad\n", name, joint, 1e3 * before, 1e3 * after);
        EXPECT_LT(after, 0.03 * before);
      }
    }
  }
}

// Takes ten minutes.
TEST_F(RealArms, DISABLED_AWristIsPredictedInRecordingsThatAreNotFitted) {
  const std::vector<std::string> names{
      "seen_joints_wrist_one_joint_a", "seen_joints_wrist_one_joint_b",
      "seen_joints_wrist_one_joint_c", "seen_joints_random_motion"};
  for (const std::string& left_out : names) {
    std::vector<ArmData> fitted;
    for (const std::string& name : names)
      if (name != left_out) fitted.push_back(Read(name));
    EXPECT_LT(TipRatio(fitted, Read(left_out)), 0.8) << left_out;
  }
  const Recording random = ReadRecording(kArms / names.back()).recording;
  const ArmData halves[] = {SeenBetween(random, 0.0, 0.5, "first half"),
                            SeenBetween(random, 0.5, 1.0, "second half")};
  std::vector<ArmData> wrist;
  wrist.reserve(names.size());
  for (int i = 0; i < 3; ++i) wrist.push_back(Read(names[i]));
  for (const int fitted : {0, 1}) {
    EXPECT_LT(TipRatio({halves[fitted]}, halves[1 - fitted]), 0.5);
    auto with_wrist = wrist;
    with_wrist.push_back(halves[fitted]);
    EXPECT_LT(TipRatio(with_wrist, halves[1 - fitted]), 0.8);
  }
}

TEST_F(RealArms, PlayAndOffsetsOfTheWristAreFound) {
  const ArmResult result = Diagnose({Read("seen_joints_wrist_one_joint_a")});
  EXPECT_THAT(result.answer.verdict, Contains("joint_offset"));
  EXPECT_THAT(result.answer.verdict, Contains("joint_backlash"));
  EXPECT_LT(result.answer.gain.tip_error_ratio, 0.1);
}

}  // namespace
}  // namespace flextip::arms
