// The drawing of an arm: lengths as they are, no joint behind another.
#include "arms/diagnose/side_view.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/arms/made_arm.h"

namespace flextip::arms {
namespace {

/// An arm whose joints all turn about one direction: it lies in a plane.
ArmData Planar(const std::vector<double>& lengths_m) {
  Arm arm;
  for (const double a_m : lengths_m) {
    ArmJoint joint;
    joint.a_m = a_m;
    PlaceJoint(arm.convention, joint);
    arm.joints.push_back(joint);
  }
  Recording recording = ArmRecording(arm);
  recording.joints0 = SmoothMotion(arm, 50, 100.0, 3);
  recording.joints_seen0 = recording.joints0;
  return {recording, "planar"};
}

TEST(SideView, KeepsLengthsOfAnArmInAPlane) {
  const ArmData data = Planar({0.0, 0.3, 0.2, 0.25});
  const auto view = SideView(data);
  ASSERT_EQ(view.size(), 5u);
  EXPECT_NEAR((view[2] - view[1]).norm(), 0.3, 0.05);  // the first joint sits at the base
  EXPECT_NEAR((view[3] - view[2]).norm(), 0.2, 1e-9);
  EXPECT_NEAR((view[4] - view[3]).norm(), 0.25, 1e-9);
}

TEST(SideView, SetsJointsAtOnePlaceApart) {
  const auto view = SideView(Planar({0.0, 0.0, 0.0, 0.4, 0.0}));
  double least = 1.0;
  for (std::size_t i = 1; i < view.size(); ++i)
    least = std::min(least, (view[i] - view[i - 1]).norm());
  EXPECT_GT(least, 0.05 * 0.4 - 1e-9);
}

}  // namespace
}  // namespace flextip::arms
