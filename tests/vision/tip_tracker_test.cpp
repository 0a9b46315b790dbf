// The tracker on pictures and corners with known truth.
#include "vision/tracking/tip_tracker.h"
#include "core/linear_algebra.h"

#include <gtest/gtest.h>

#include <random>

#include "core/error.h"
#include "core/rotation.h"
#include "tests/vision/synthetic_tag.h"

namespace flextip {
namespace {

constexpr TimeNs kFrame_ns = 33'333'333;
const TagCollar kCollar = PrismCollar(6, 0.005, 0.005, -0.03);

// A slow sweep: some 3 mm and 3 degrees in ten frames.
Pose SweepPose(int frame) {
  const double u = frame / 10.0;
  Pose T_CE;
  T_CE.R = ExpRotation({0.05 * u, 0.3 + 0.05 * u, -0.2}) * ExpRotation({-M_PI / 2 - 0.4, 0, 0});
  T_CE.p = Eigen::Vector3d(0.025 + 0.003 * u, 0.005 - 0.001 * u, 0.11 + 0.002 * u);
  return T_CE;
}

TEST(TipTracker, FollowsTheTipInPictures) {
  const CameraCalibration camera = TestCamera(true);
  TipTracker tracker(camera, kCollar);
  double squared = 0;
  constexpr int kFrames = 6;
  for (int i = 0; i < kFrames; ++i) {
    const Pose T_CE = SweepPose(i);
    SyntheticOptions synthetic;
    synthetic.seed = static_cast<unsigned>(i + 1);
    synthetic.margin_cells = 0.5;
    const Image image = RenderTags(camera, FacingTags(kCollar, T_CE), synthetic);
    const TipTrack track = tracker.Track(image, i * kFrame_ns);
    ASSERT_EQ(track.tip.status, TipStatus::kOk);
    const Pose T_RE = camera.T_RC * T_CE;
    squared += (track.tip.p_RE - T_RE.p).squaredNorm() / kFrames;
    EXPECT_EQ(track.tip.p_RE, track.T_RE.p);
    ASSERT_TRUE(track.tip.d_RE);
    EXPECT_LT(std::acos(track.tip.d_RE->dot(T_RE.R.col(0))), 0.01);
  }
  EXPECT_LT(std::sqrt(squared), 0.15e-3);
}

// With noise the tracker has to learn: the normalised squared error of the tip averages 3.
TEST(TipTracker, CovarianceIsHonest) {
  const CameraCalibration camera = TestCamera(true);
  for (const double noise_px : {0.06, 0.3}) {
    std::mt19937 random(11);
    TrackerOptions options;
    options.max_ok_sd_m = options.max_ok_sd_rad = 0.1;  // corners this noisy are sure of nothing
    TipTracker tracker(camera, kCollar, options);
    double nees = 0, direction = 0;
    int n = 0;
    for (int i = 0; i < 1500; ++i) {
      const Pose T_CE = SweepPose(i % 20);
      const TipTrack track =
          tracker.Track(NoisyTags(camera, kCollar, T_CE, noise_px, random), i * kFrame_ns);
      ASSERT_EQ(track.tip.status, TipStatus::kOk);
      if (i < 20) continue;  // the first frames learn the noise
      const Pose T_RE = camera.T_RC * T_CE;
      const Eigen::Vector3d e = track.tip.p_RE - T_RE.p;
      nees += MahalanobisSquared(e, track.tip.covariance_m2);
      direction += (*track.tip.d_RE - T_RE.R.col(0)).squaredNorm() /
                   (2 * track.direction_noise_rad * track.direction_noise_rad);
      ++n;
    }
    // 4 standard deviations of the mean, and 3 % for the noise level's own scatter.
    EXPECT_NEAR(nees / n, 3.0, 4 * std::sqrt(6.0 / n) + 0.1) << noise_px;
    EXPECT_NEAR(direction / n, 1.0, 0.12) << noise_px;
  }
}

TEST(TipTracker, PredictsBrieflyThenIsLostThenRecovers) {
  const CameraCalibration camera = TestCamera(true);
  TipTracker tracker(camera, kCollar);
  std::mt19937 random(12);
  int frame = 0;
  for (; frame < 10; ++frame) {
    tracker.Track(NoisyTags(camera, kCollar, SweepPose(frame), 0.05, random), frame * kFrame_ns);
  }
  double trace = 0;
  for (int i = 0; i < 3; ++i, ++frame) {
    const TipTrack track = tracker.Track(std::vector<TagDetection>{}, frame * kFrame_ns);
    ASSERT_EQ(track.tip.status, TipStatus::kPredicted);
    EXPECT_FALSE(track.tip.d_RE);
    EXPECT_GT(track.tip.covariance_m2.trace(), trace);
    trace = track.tip.covariance_m2.trace();
    const Eigen::Vector3d e = track.tip.p_RE - (camera.T_RC * SweepPose(frame)).p;
    EXPECT_LT(MahalanobisSquared(e, track.tip.covariance_m2), 16.3);  // 99.9 % of chi-square 3
  }
  for (int i = 0; i < 3; ++i, ++frame) {
    const TipTrack track = tracker.Track(std::vector<TagDetection>{}, frame * kFrame_ns);
    EXPECT_EQ(track.tip.status, TipStatus::kLost);
  }
  const TipTrack again =
      tracker.Track(NoisyTags(camera, kCollar, SweepPose(frame), 0.05, random), frame * kFrame_ns);
  EXPECT_EQ(again.tip.status, TipStatus::kOk);
}

TEST(TipTracker, NothingIsPredictedBeforeTheFirstSightOrAfterALongGap) {
  const CameraCalibration camera = TestCamera(true);
  TipTracker tracker(camera, kCollar);
  EXPECT_EQ(tracker.Track(std::vector<TagDetection>{}, 0).tip.status, TipStatus::kLost);
  std::mt19937 random(13);
  tracker.Track(NoisyTags(camera, kCollar, SweepPose(1), 0.05, random), kFrame_ns);
  const TimeNs second_ns = 1'000'000'000;
  EXPECT_EQ(tracker.Track(std::vector<TagDetection>{}, second_ns).tip.status, TipStatus::kLost);
}

TEST(TipTracker, RejectsWhatItCannotUse) {
  const CameraCalibration camera = TestCamera(true);
  TipTracker tracker(camera, kCollar);
  EXPECT_THROW(tracker.Track(Image(), 0), InputError);
  EXPECT_THROW(tracker.Track(Image(640, 480, 1), 0), InputError);
  EXPECT_THROW(TipTracker(camera, TagCollar{}), InputError);
  TagCollar twice = kCollar;
  twice.tags[1].id = 0;
  EXPECT_THROW(TipTracker(camera, twice), InputError);
  TagCollar flat = kCollar;
  flat.tags[0].size_m = 0;
  EXPECT_THROW(TipTracker(camera, flat), InputError);
}

}  // namespace
}  // namespace flextip
