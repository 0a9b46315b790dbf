// The tracker on rendered sequences: what it must follow, carry on, and refuse.
#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <thread>

#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "tests/vision/scope_scene.h"
#include "vision/tags/reprojection.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {
namespace {

constexpr TimeNs kFrame_ns = 33'333'333;
const Pose kAway = ScopePose(0, 0, {0.5, 0, 0});

class Scene {
 public:
  explicit Scene(const TagCollar& collar = ScopeCollar(),
                 const CameraCalibration& camera = ScopeCamera())
      : scope_(camera, collar, ScopeOptions(ScopeCamera())) {}
  Image At(const Pose& T_RE, int frame) const { return scope_.Render(ScopeShaft(T_RE), frame); }

 private:
  simulation::Laparoscope scope_;
};

double Error_mm(const TipTrack& track, const Pose& T_RE) {
  return 1e3 * (track.tip.p_RE - T_RE.p).norm();
}

// 30 px at 0.1 m and 600 px of focal length are 5 mm.
TEST(TipTrackerVideo, FollowsJumpsOf30Pixels) {
  const Scene scene;
  TipTracker tracker(ScopeCamera(), ScopeCollar());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  Eigen::Vector3d offset_C(0, 0, 0);
  for (int i = 0; i < 14; ++i) {
    const double angle = M_PI * unit(random);
    Eigen::Vector3d next = offset_C + 0.005 * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0);
    if (std::abs(next.x()) > 0.012 || std::abs(next.y()) > 0.01)
      next = offset_C - 0.005 * offset_C.normalized();
    offset_C = next;
    const Eigen::Vector2d turn = DrawVector<2>(unit, random);
    const Pose T_RE = ScopePose(0.2 + 0.02 * turn.x(), 0.25 + 0.03 * turn.y(), offset_C);
    const TipTrack track = tracker.Track(scene.At(T_RE, i), i * kFrame_ns);
    ASSERT_EQ(track.tip.status, TipStatus::kOk) << i;
    EXPECT_LT(Error_mm(track, T_RE), 0.15) << i;
  }
}

// One tag alone turns through facing the camera: both of its poses fit nearly alike there.
TEST(TipTrackerVideo, OneFlatTagDoesNotFlip) {
  const TagCollar one = OnlyTag(ScopeCollar(), 0);
  const Scene scene(one);
  TipTracker tracker(ScopeCamera(), one);
  int ok = 0;
  constexpr int kFrames = 28;
  for (int i = 0; i < kFrames; ++i) {
    const double turn = -0.7 + 1.4 * i / (kFrames - 1);
    const Pose T_RE = ScopePose(turn, 0.3);
    const TipTrack track = tracker.Track(scene.At(T_RE, i), i * kFrame_ns);
    if (track.tip.status != TipStatus::kOk) continue;
    ++ok;
    EXPECT_LT(LogRotation(track.T_RE.R * T_RE.R.transpose()).norm(), 0.1) << i;
    const Eigen::Vector3d e = track.tip.p_RE - T_RE.p;
    EXPECT_LT(MahalanobisSquared(e, track.tip.covariance_m2), 25) << i;
  }
  EXPECT_GE(ok, kFrames - 3);
}

// A blurred picture of a linear camera that does not say so: from the usual gamma alone the pixels
// cannot be fitted.
TEST(TipTrackerVideo, AnUnstatedGammaOfOneIsFound) {
  CameraCalibration camera = ScopeCamera();
  camera.gamma.reset();
  for (const double blur_px : {1.0, 1.6}) {
    const Pose T_RE = ScopePose(0.2, 0.25);
    const Image image = Film(LightThroughLens(camera, ScopeCollar(), T_RE, blur_px), 1.0, 3);
    TipTracker tracker(camera, ScopeCollar());
    const TipTrack track = tracker.Track(image, 0);
    ASSERT_EQ(track.tip.status, TipStatus::kOk) << blur_px;
    EXPECT_LT(Error_mm(track, T_RE), 0.1) << blur_px;
  }
}

TEST(TipTrackerVideo, TheFirstPicturesCornersAreThoseOfTheFit) {
  const Pose T_RE = ScopePose(0.2, 0.25);
  const CameraCalibration camera = ScopeCamera();
  const CameraModel model(camera);
  const Image image = Film(LightThroughLens(camera, ScopeCollar(), T_RE, 0.8), 2.2, 4);
  const TagCollar collar = ScopeCollar();
  TipTracker tracker(camera, collar);
  const TipTrack track = tracker.Track(image, 0);
  ASSERT_EQ(track.tip.status, TipStatus::kOk);
  ASSERT_GE(track.tags.size(), 2u);
  for (const TagDetection& found : track.tags) {
    const CollarTag& tag = collar.tags.at(static_cast<std::size_t>(found.id));
    ASSERT_EQ(tag.id, found.id);
    const auto corners_E = CornersInE(tag);
    for (int i = 0; i < 4; ++i) {
      const auto px = model.Project(camera.T_RC.Inverse() * (T_RE * corners_E[i]));
      ASSERT_TRUE(px);
      EXPECT_LT((found.corners_px[i] - *px).norm(), 0.05) << found.id;
    }
  }
}

TEST(TipTrackerVideo, TheModelCarriesAHiddenTip) {
  const Scene scene;
  TipTracker tracker(ScopeCamera(), ScopeCollar());
  TipPrediction model;
  model.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 4e-6, 4e-6, 4e-6;
  int frame = 0;
  const auto pose = [](int i) { return ScopePose(0.2, 0.25, {0.0005 * i, 0, 0}); };
  const auto track = [&](bool seen) {
    model.T_RE = pose(frame);
    model.T_RE.p += Eigen::Vector3d(0.001, 0, 0);
    const TipTrack result =
        tracker.Track(scene.At(seen ? pose(frame) : kAway, frame), frame * kFrame_ns, model);
    ++frame;
    return result;
  };
  for (int i = 0; i < 3; ++i) EXPECT_EQ(track(true).tip.status, TipStatus::kOk);
  for (int i = 0; i < 12; ++i) {
    const TipTrack hidden = track(false);
    ASSERT_EQ(hidden.tip.status, TipStatus::kPredicted) << i;
    EXPECT_FALSE(hidden.tip.d_RE);
    if (i < 8) continue;  // the motion of the tip seen last is long forgotten
    EXPECT_EQ(hidden.tip.p_RE, model.T_RE.p);
    EXPECT_EQ(hidden.tip.covariance_m2, (model.covariance.bottomRightCorner<3, 3>()));
  }
  const TipTrack again = track(true);
  ASSERT_EQ(again.tip.status, TipStatus::kOk);
  EXPECT_LT(Error_mm(again, pose(frame - 1)), 0.1);
}

TEST(TipTrackerVideo, ALostTipIsFoundInTheBackground) {
  const Scene scene;
  TrackerOptions options;
  options.background_detection = true;
  TipTracker tracker(ScopeCamera(), ScopeCollar(), options);
  const Pose T_RE = ScopePose(0.2, 0.25);
  const Image seen = scene.At(T_RE, 0), empty = scene.At(kAway, 1);
  EXPECT_EQ(tracker.Track(empty, 0).tip.status, TipStatus::kLost);
  TipTrack track;
  int frame = 1;
  for (; frame < 400 && track.tip.status != TipStatus::kOk; ++frame) {
    track = tracker.Track(seen, frame * kFrame_ns);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ASSERT_EQ(track.tip.status, TipStatus::kOk);
  EXPECT_GT(frame, 2);  // not in the frame in which it came
  EXPECT_LT(Error_mm(track, T_RE), 0.1);
}

TEST(TipTrackerVideo, TwoCamerasAndEitherAlone) {
  const std::vector<CameraCalibration> cameras = {ScopeCamera(), SecondScopeCamera()};
  const Scene first(ScopeCollar(), cameras[0]), second(ScopeCollar(), cameras[1]);
  TipTracker tracker(cameras, ScopeCollar());
  for (int i = 0; i < 12; ++i) {
    const Pose T_RE = ScopePose(0.2, 0.25, {0.0007 * i, 0.0003 * i, 0});
    const Image a = first.At(T_RE, i), b = second.At(T_RE, i);
    const bool no_a = i == 5 || i == 6, no_b = i == 8 || i == 9;
    const std::vector<const Image*> images = {no_a ? nullptr : &a, no_b ? nullptr : &b};
    const TipTrack track = tracker.Track(images, i * kFrame_ns);
    ASSERT_EQ(track.tip.status, TipStatus::kOk) << i;
    EXPECT_LT(Error_mm(track, T_RE), no_a || no_b ? 0.1 : 0.03) << i;
    const Eigen::Vector3d e = track.tip.p_RE - T_RE.p;
    EXPECT_LT(MahalanobisSquared(e, track.tip.covariance_m2), 16.3) << i;
  }
}

TEST(TipTrackerVideo, AnEmptySceneHasNoTip) {
  const Scene scene;
  TipTracker tracker(ScopeCamera(), ScopeCollar());
  const Pose T_RE = ScopePose(0.2, 0.25);
  for (int i = 0; i < 3; ++i) tracker.Track(scene.At(T_RE, i), i * kFrame_ns);
  for (int i = 3; i < 20; ++i) {
    const TipStatus status = tracker.Track(scene.At(kAway, i), i * kFrame_ns).tip.status;
    EXPECT_EQ(status, i < 6 ? TipStatus::kPredicted : TipStatus::kLost) << i;
  }
}

// With the place known, and without: borders alike and half of the cells must not do.
TEST(TipTrackerVideo, ACollarOfOtherIdsIsNeverTaken) {
  for (const bool known : {false, true}) {
    TipTracker tracker(ScopeCamera(), ScopeCollar());
    for (int i = 0; i < 12; ++i) {
      const Scene scene(ScopeCollar(0, 13 + 8 * i));
      const Pose T_RE = ScopePose(0.2, 0.25, {0.0005 * i, 0, 0});
      TipPrediction model{T_RE, {}};
      model.covariance.setZero();
      model.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 4e-6, 4e-6, 4e-6;
      const TipTrack track =
          tracker.Track(scene.At(T_RE, i), i * kFrame_ns,
                        known ? std::optional<TipPrediction>(model) : std::nullopt);
      EXPECT_NE(track.tip.status, TipStatus::kOk)
          << known << " " << i << " noise " << track.noise_grey << " tags " << track.tags_used;
    }
  }
}

}  // namespace
}  // namespace flextip
