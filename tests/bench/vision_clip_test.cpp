#include "bench/vision/clip.h"

#include <gtest/gtest.h>

#include "core/rotation.h"

namespace flextip::bench {
namespace {

// Between two frames the collar goes on by the step that its case states, along all of the circle:
// a jump would be a lost tip to whoever tracks.
TEST(VisionClip, MovesByTheStepStated) {
  for (const int width_px : {640, 1280, 1920}) {
    for (const double step_px : {5.0, 30.0}) {
      const ClipCase one{"", width_px, step_px};
      const double f_px = BenchCamera(width_px, 2.2).fu_px;
      double longest_px = 0;
      for (int i = 0; i < 200; ++i) {
        const Pose before = ClipPose(one, i), after = ClipPose(one, i + 1);
        const Eigen::Vector3d a = before * ClipMiddle_E(), b = after * ClipMiddle_E();
        longest_px = std::max(longest_px, f_px * (b.hnormalized() - a.hnormalized()).norm());
        const double turn = LogRotation(after.R * before.R.transpose()).norm();
        EXPECT_LT(turn, 0.05 + step_px / f_px) << width_px << " " << step_px << " " << i;
        EXPECT_LT((after.p - before.p).norm(), (b - a).norm() + 0.03 * turn + 1e-9);
      }
      EXPECT_LE(longest_px, step_px);
      EXPECT_GT(longest_px, 0.99 * step_px);
    }
  }
}

// All tags of a row, and one of a hexagon, look to the camera in every frame.
TEST(VisionClip, IsSeenInEveryFrame) {
  const ClipCase cases[] = {{"", 640},        {"", 1280, 30},       {"", 1280, 5, 1},
                            {"", 1280, 5, 4}, {"", 1280, 5, 0, 20}, {"", 1280, 5, 0, 100}};
  for (const ClipCase& one : cases) {
    const CameraModel camera(BenchCamera(one.width_px, 2.2));
    for (int i = 0; i < 200; ++i) {
      const auto seen = TagsInView(camera, ClipCollar(one), ClipPose(one, i), 70 * M_PI / 180);
      EXPECT_GE(seen.size(), one.tags == 0 ? 1u : static_cast<std::size_t>(one.tags)) << i;
    }
  }
}

}  // namespace
}  // namespace flextip::bench
