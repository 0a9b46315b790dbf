// What is put into a recording is found, and what is not there is not claimed.
#include "arms/diagnose/diagnose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "arms/diagnose/model_file.h"
#include "arms/diagnose/predict.h"
#include "recording/text/text.h"
#include "tests/arms/made_arm.h"
#include "tests/arms/wrist_of_cables.h"

namespace flextip::arms {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Not;

const std::vector<double> kSeenNoise{3e-4, 2e-4, 5e-5, 1e-3, 4e-4, 6e-4};

Recording SeenAtStops(unsigned seed) {
  Recording recording = ArmRecording(SixJoints());
  recording.joints_command0 = Stops(*recording.arm, 300, seed);
  recording.joints_seen0 = WithNoise(*recording.joints_command0, kSeenNoise, seed + 100);
  return recording;
}

/// Adds to seen joint `to` what `of` makes of all commanded values of joint `from`.
template <class Of>
void AddToSeen(Recording& recording, int to, int from, Of of) {
  const auto& commanded = recording.joints_command0->q;
  Eigen::VectorXd x(Eigen::Index(commanded.size()));
  for (Eigen::Index k = 0; k < x.size(); ++k) x[k] = commanded[k].value[from];
  const Eigen::VectorXd added = of(x);
  for (Eigen::Index k = 0; k < x.size(); ++k) recording.joints_seen0->q[k].value[to] += added[k];
}

/// Where a follower in a play of this whole width is behind `x`: pushed along by either side. Not
/// the code under test.
Eigen::VectorXd Behind(const Eigen::VectorXd& x, double width) {
  Eigen::VectorXd behind(x.size());
  double at = x[0];
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    if (x[k] - at > 0.5 * width) at = x[k] - 0.5 * width;
    if (x[k] - at < -0.5 * width) at = x[k] + 0.5 * width;
    behind[k] = at - x[k];
  }
  return behind;
}

double ValueOf(const ArmResult& result, const std::string& effect, const std::string& parameter,
               int i) {
  for (const auto& fit : result.answer.parameters)
    for (const auto& p : fit.parameters)
      if (fit.effect == effect && p.name == parameter) return p.value[i];
  return std::nan("");
}

TEST(DiagnoseArm, HealthyJointsGiveNone) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const ArmResult result = Diagnose({ArmData(SeenAtStops(seed), "healthy")});
    EXPECT_THAT(result.answer.verdict, ElementsAre("none")) << seed;
    EXPECT_GT(result.answer.probabilities.front().probability, 0.6);
  }
}

TEST(DiagnoseArm, FindsOffsetsOfTheJointsThatHaveThem) {
  Recording recording = SeenAtStops(4);
  AddToSeen(recording, 3, 3,
            [](const Eigen::VectorXd& x) { return Eigen::VectorXd::Constant(x.size(), 0.02); });
  const ArmResult result = Diagnose({ArmData(recording, "offset")});
  EXPECT_THAT(result.answer.verdict, ElementsAre("joint_offset"));
  EXPECT_NEAR(ValueOf(result, "joint_offset", "offset", 3), 0.02, 5e-4);
  EXPECT_NEAR(ValueOf(result, "joint_offset", "offset", 0), 0.0, 5e-4);
  EXPECT_LT(result.answer.gain.heldout_error_ratio, 0.3);
}

TEST(DiagnoseArm, SaysInWhichRecordingAnOffsetBegan) {
  Recording later = SeenAtStops(12);
  AddToSeen(later, 3, 3,
            [](const Eigen::VectorXd& x) { return Eigen::VectorXd::Constant(x.size(), 0.02); });
  const ArmResult result = Diagnose({ArmData(SeenAtStops(11), "before"), ArmData(later, "after")});
  ASSERT_EQ(result.changes.size(), 1u);
  EXPECT_EQ(result.changes[0].effect, "joint_offset");
  EXPECT_EQ(result.changes[0].first_in, 1);
  const auto& presence = result.presence_in.at("joint_offset");
  EXPECT_LT(presence[0], 0.1);
  EXPECT_GT(presence[1], 0.9);
}

TEST(DiagnoseArm, FindsAScaleAndACoupling) {
  Recording recording = SeenAtStops(5);
  AddToSeen(recording, 1, 1, [](const Eigen::VectorXd& x) { return Eigen::VectorXd(0.02 * x); });
  AddToSeen(recording, 5, 4, [](const Eigen::VectorXd& x) { return Eigen::VectorXd(0.1 * x); });
  const ArmResult result = Diagnose({ArmData(recording, "two")});
  EXPECT_THAT(result.answer.verdict,
              testing::UnorderedElementsAre("joint_coupling", "joint_scale"));
  EXPECT_NEAR(ValueOf(result, "joint_scale", "scale", 1), 1.02, 2e-3);
  EXPECT_NEAR(ValueOf(result, "joint_coupling", "matrix", 29), 0.1, 5e-3);
}

// One joint stands in a corner of its play as the recording begins; the model predicts another
// motion.
TEST(DiagnoseArm, FindsAWristWhoseJointsDragEachOther) {
  const WristOfCables wrist;
  const ArmResult result = Diagnose({ArmData(RecordedWrist(wrist, kSeenNoise, 21, 0.5), "wrist")});
  EXPECT_THAT(result.answer.verdict, ElementsAre("joint_backlash"));
  const Eigen::Matrix2d moved = wrist.Moved();
  EXPECT_NEAR(ValueOf(result, "joint_backlash", "width", 4), moved(0, 0), 0.02);
  EXPECT_NEAR(ValueOf(result, "joint_backlash", "width", 5), moved(1, 1), 0.02);
  const ArmPrediction prediction =
      Predict(ArmData(RecordedWrist(wrist, kSeenNoise, 22, -0.5), "other"), result.model);
  EXPECT_LT(prediction.ratio, 0.1);
}

// Joints that springs pull back stay short of their motors, and that is no gear's ratio.
TEST(DiagnoseArm, AWristThatSpringsPullBackHasNoScale) {
  const WristOfCables wrist{.spring_x = 0.1, .spring_y = 0.15};
  const ArmResult result = Diagnose({ArmData(RecordedWrist(wrist, kSeenNoise, 23, 0.5), "wrist")});
  EXPECT_THAT(result.answer.verdict, ElementsAre("joint_backlash"));
  EXPECT_THAT(
      result.not_told,
      Contains("joint_scale of joints 5, 6 cannot be told from springs that pull them back"));
  const Eigen::Matrix2d moved = wrist.Moved();
  EXPECT_NEAR(ValueOf(result, "joint_backlash", "width", 4), moved(0, 0), 0.02);
  EXPECT_NEAR(ValueOf(result, "joint_backlash", "width", 5), moved(1, 1), 0.02);
  const ArmPrediction prediction =
      Predict(ArmData(RecordedWrist(wrist, kSeenNoise, 24, -0.5), "other"), result.model);
  EXPECT_LT(prediction.ratio, 0.1);
}

TEST(DiagnoseArm, FindsPlayThatDragsAnotherJoint) {
  Recording recording = SeenAtStops(6);
  AddToSeen(recording, 4, 4, [](const Eigen::VectorXd& x) { return Behind(x, 0.05); });
  AddToSeen(recording, 5, 4,
            [](const Eigen::VectorXd& x) { return Eigen::VectorXd(0.4 * Behind(x, 0.05)); });
  const ArmResult result = Diagnose({ArmData(recording, "play")});
  EXPECT_THAT(result.answer.verdict, ElementsAre("joint_backlash"));
  EXPECT_NEAR(ValueOf(result, "joint_backlash", "width", 4), 0.05, 0.005);
  EXPECT_NEAR(ValueOf(result, "joint_backlash", "drag", 29), 0.4, 0.08);
}

TEST(DiagnoseArm, ClaimsNoLatencyAtStops) {
  const ArmResult result = Diagnose({ArmData(SeenAtStops(7), "stops")});
  EXPECT_THAT(result.answer.catalogue, Not(Contains("command_latency")));
  EXPECT_THAT(result.answer.catalogue, Not(Contains("servo_lag")));
}

TEST(DiagnoseArm, FoundModelPredictsAnotherMotion) {
  Recording recording = SeenAtStops(8), other = SeenAtStops(9);
  for (Recording* r : {&recording, &other})
    AddToSeen(*r, 3, 3, [](const Eigen::VectorXd& x) {
      return Eigen::VectorXd(0.04 + Behind(x, 0.06).array());
    });
  const ArmResult result = Diagnose({ArmData(recording, "first")});
  const auto file = std::filesystem::temp_directory_path() / "flextip_arm_model_test.yaml";
  WriteTextFile(file, ArmModelYaml(result.model));
  const ArmPrediction prediction = Predict(ArmData(other, "second"), ReadArmModel(file));
  std::filesystem::remove(file);
  EXPECT_LT(prediction.ratio, 0.2);
  EXPECT_LT(prediction.extended_rms.at("joints_seen0_q4_rad"), 3e-3);
  EXPECT_GT(prediction.base_rms.at("joints_seen0_q4_rad"), 3e-2);
}

TEST(DiagnoseArm, RefusesTooFewRows) {
  Recording recording = SeenAtStops(10);
  recording.joints_command0->q.resize(19);
  recording.joints_seen0->q.resize(19);
  EXPECT_THROW(ArmData(recording, "short"), InputError);
}

TEST(DiagnoseArm, RefusesAnotherArm) {
  Recording other = ArmRecording(ThreeJointsWithMasses());
  other.joints0 = SmoothMotion(*other.arm, 100, 50.0, 1);
  other.joints_seen0 = other.joints0;
  EXPECT_THROW(Diagnose({ArmData(SeenAtStops(1), "a"), ArmData(other, "b")}), InputError);
}

TEST(DiagnoseArm, RefusesOneRecordingTwice) {
  EXPECT_THROW(Diagnose({ArmData(SeenAtStops(1), "a"), ArmData(SeenAtStops(1), "b")}), InputError);
}

}  // namespace
}  // namespace flextip::arms
