// The tip on a tag collar from rendered frames: the collar's own frame is not at the tip, and only
// the pixels say by how much.
#include <gtest/gtest.h>

#include "calibration/tip/tip_poses.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "tests/vision/scope_scene.h"

namespace flextip {
namespace {

constexpr int kFrames = 24;

/// The shaft turned about the tip p_E, which stays where it is in the first frame.
Pose TurnedAbout(const Eigen::Vector3d& p_E, int i) {
  const double a = 2 * M_PI * i / kFrames;
  Pose T_RE = ScopePose(0.35 + 0.3 * std::cos(a), 0.35 * std::sin(a + 0.7) + 0.2);
  T_RE.R = ExpRotation(0.35 * std::sin(a) * ScopeCamera().T_RC.R.col(2)) * T_RE.R;
  const Pose start = ScopePose(0.35, 0.2);
  T_RE.p = start * p_E - T_RE.R * p_E;
  return T_RE;
}

TEST(TipCollar, TheHiddenOffsetIsFoundInTheFrames) {
  const Eigen::Vector3d p_E(0.0023, -0.0011, 0.0007);
  const CameraCalibration camera = ScopeCamera();
  const TagCollar collar = ScopeCollar();
  simulation::Laparoscope scope(camera, collar, ScopeOptions(camera));
  TipTracker tracker(camera, collar);
  std::vector<PivotPose> poses;
  for (int i = 0; i < kFrames; ++i) {
    const TimeNs t_ns = i * TimeNs{40'000'000};
    const Image image = scope.Render(ScopeShaft(TurnedAbout(p_E, i)), i);
    if (const auto pose = CollarPivotPose(tracker.Track(image, t_ns), t_ns)) poses.push_back(*pose);
  }
  ASSERT_GE(poses.size(), 15u);
  const PivotResult result = CalibratePivot(poses, {.separate_noise = false});
  ASSERT_EQ(result.status, PivotStatus::kOk) << result.unobservable;
  const Eigen::Vector3d e = result.p_BE - p_E;
  RecordProperty("error_um", static_cast<int>(1e6 * e.norm()));
  const Eigen::Matrix3d C = result.covariance.topLeftCorner<3, 3>();
  EXPECT_LT(e.norm(), 2e-4) << e.transpose() << " scale " << result.position_noise_scale;
  EXPECT_LT(MahalanobisSquared(e, C), 16.3) << C.diagonal().cwiseSqrt().transpose();  // 99.9 %
}

}  // namespace
}  // namespace flextip
