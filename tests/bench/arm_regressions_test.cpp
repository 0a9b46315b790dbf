// Plain regressions of joints against what was put into them.
#include "bench/arm_regressions/regress.h"

#include <gtest/gtest.h>

#include "arms/effects/play.h"
#include "tests/arms/made_arm.h"

namespace flextip::bench {
namespace {

const Left& Of(const std::vector<Left>& all, const std::string& name) {
  for (const Left& left : all)
    if (left.name == name) return left;
  throw std::runtime_error("no " + name);
}

/// Joint 4 is 20 mrad off, joint 5 has a play of 80 mrad; joints 1 to 3 stand still.
arms::ArmData Seen(unsigned seed) {
  Recording recording = arms::ArmRecording(arms::SixJoints());
  recording.joints_command0 = arms::Stops(*recording.arm, 300, seed);
  for (auto& sample : recording.joints_command0->q) sample.value.head(3) << 0.1, 0.2, 0.15;
  recording.joints_seen0 = recording.joints_command0;
  Eigen::VectorXd x(300);
  for (int k = 0; k < 300; ++k) x[k] = recording.joints_command0->q[std::size_t(k)].value[4];
  const Eigen::VectorXd state = arms::PlayState(x, 0.08);
  for (int k = 0; k < 300; ++k) {
    recording.joints_seen0->q[std::size_t(k)].value[3] += 0.02;
    recording.joints_seen0->q[std::size_t(k)].value[4] += 0.08 * state[k];
  }
  return {recording, "seen"};
}

TEST(ArmRegressions, LeaveWhatTheyCannotSay) {
  const std::vector<Left> all = RegressSeen({Seen(1)}, Seen(2));
  EXPECT_NEAR(Of(all, "nothing").joints[3], 0.02, 1e-9);
  EXPECT_LT(Of(all, "offset").joints[3], 1e-9);
  EXPECT_GT(Of(all, "offset").joints[4], 0.02);
  EXPECT_LT(Of(all, "offset, play").joints[4], 0.01);
  // Joints that stand still have no weights that another recording could be led astray by.
  for (const Left& left : all) EXPECT_LT(left.tip_m, 0.1) << left.name;
}

TEST(ArmRegressions, OneDelayIsFound) {
  Recording recording = arms::ArmRecording(arms::SixJoints());
  recording.joints_command0 = arms::SmoothMotion(*recording.arm, 600, 100.0, 3);
  recording.joints0 = recording.joints_command0;
  for (auto& sample : recording.joints0->q) sample.t_ns += 20'000'000;
  const arms::ArmData late(recording, "late");
  const std::vector<Left> all = RegressFollowed({late}, late);
  EXPECT_LT(Of(all, "one delay").tip_m, 0.02 * Of(all, "nothing").tip_m);
}

}  // namespace
}  // namespace flextip::bench
