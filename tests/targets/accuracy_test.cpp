// The accuracy that a collar promises, against the tracker's errors in rendered pictures.
#include "targets/collar/accuracy.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "core/error.h"
#include "core/rotation.h"
#include "simulation/render/laparoscope.h"
#include "targets/collar/design.h"
#include "targets/collar/tag_information.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {
namespace {

CameraCalibration Camera() {
  CameraCalibration camera;
  camera.width_px = 1280;
  camera.height_px = 720;
  camera.fu_px = camera.fv_px = 950;
  camera.cu_px = 639.5;
  camera.cv_px = 359.5;
  camera.gamma = 2.2;
  return camera;
}

Pose PoseAt(double distance_m, double roll) {
  Pose T_CE;
  T_CE.R = ExpRotation({0, -0.4363, 0}) * ExpRotation({roll, 0, 0});
  T_CE.p = Eigen::Vector3d(0, 0, distance_m) + T_CE.R * Eigen::Vector3d(0.03, 0, 0);
  return T_CE;
}

/// Returns the light of a straight shaft with the collar, white paper near 60 % of the range.
simulation::LinearImage Light(const CollarDesign& d, const Pose& T_CE, double distance_m) {
  simulation::LaparoscopeOptions options;
  options.tissue.point_R = {0, 0, 2.5 * distance_m};
  options.tissue.normal_R = {0, 0, -1};
  options.tissue.albedo_bgr = {0.3, 0.3, 0.3};
  options.exposure = 0.65;
  options.exposure_distance_m = distance_m;
  options.vignetting = 0;
  options.blur_sigma_px = 0.8;
  options.parts_per_px = 2;
  options.grey = true;
  simulation::ShaftCurve curve;
  curve.diameter_m = d.wishes.shaft_diameter_m;
  curve.T_RE = T_CE;
  for (int i = 0; i <= 20; ++i)
    curve.points.push_back(T_CE * Eigen::Vector3d(-0.3 + 0.015 * i, 0, 0));
  return simulation::Laparoscope(Camera(), d.collar, options).RenderLight(curve, 0);
}

Image Develop(const simulation::LinearImage& light, double noise_grey, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, noise_grey);
  Image image(light.width_px, light.height_px, 1);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    const double grey = 255 * std::pow(std::clamp(light.data[i], 0.0f, 1.0f), 1 / 2.2);
    image.data[i] =
        static_cast<std::uint8_t>(std::clamp(std::lround(grey + noise(random)), 0L, 255L));
  }
  return image;
}

/// Returns the tracker's RMS error over `frames` pictures of one scene with fresh noise.
double TrackedRms(const CollarDesign& d, const Pose& T_CE, double distance_m, double noise_grey,
                  int frames) {
  constexpr int kWarmUp = 10;
  const auto light = Light(d, T_CE, distance_m);
  TipTracker tracker(Camera(), d.collar);
  double sum = 0;
  int count = 0;
  for (int i = 0; i < kWarmUp + frames; ++i) {
    const auto track =
        tracker.Track(Develop(light, noise_grey, static_cast<unsigned>(i)), i * TimeNs{33'333'333});
    if (i < kWarmUp || track.tip.status != TipStatus::kOk) continue;
    sum += (track.tip.p_RE - T_CE.p).squaredNorm();
    ++count;
  }
  EXPECT_GE(count, frames * 9 / 10);
  return std::sqrt(sum / count);
}

struct Scene {
  double distance_m, roll;
};
class Accuracy : public testing::TestWithParam<Scene> {};

TEST_P(Accuracy, IsWhatTheTrackerReachesInRenderedPictures) {
  const auto [distance_m, roll] = GetParam();
  const CollarDesign d = DesignCollar({});
  const ViewingConditions conditions{.camera = Camera()};
  const Pose T_CE = PoseAt(distance_m, roll);
  const auto bound = PoseBoundOfPixels(d.collar, {Camera(), 2.5, 0.8}, T_CE);
  ASSERT_TRUE(bound);
  const double least = std::sqrt(bound->bottomRightCorner<3, 3>().trace());
  const double expected = AccuracyOver(d.collar, conditions, {distance_m})[0].expected.tip_m;
  const double tracked = TrackedRms(d, T_CE, distance_m, 2.5, 40);
  RecordProperty("least_um", fmt::format("{:.2f}", 1e6 * least));
  RecordProperty("tracked_um", fmt::format("{:.2f}", 1e6 * tracked));
  RecordProperty("expected_um", fmt::format("{:.2f}", 1e6 * expected));
  EXPECT_GT(tracked, 0.8 * least);  // 40 frames tell an RMS to a tenth or so
  EXPECT_LT(tracked, 2.5 * least);
  EXPECT_LT(tracked, 1.5 * expected);
}

INSTANTIATE_TEST_SUITE_P(Distances, Accuracy,
                         testing::Values(Scene{0.06, 0.1}, Scene{0.1, 0.35}, Scene{0.15, 0.9}));

TEST(AccuracyOfACollar, GrowsWithDistanceAndNoise) {
  const CollarDesign d = DesignCollar({});
  ViewingConditions conditions{.camera = Camera()};
  const auto table = AccuracyOver(d.collar, conditions, {0.05, 0.1, 0.2});
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_GT(table[i].least.tip_m, table[i - 1].least.tip_m);
    EXPECT_GT(table[i].expected.tip_m, table[i].least.tip_m);
    EXPECT_NEAR(table[i].tag_px, 0.5 * table[i - 1].tag_px, 1e-9);
    // Far away all that changes is the size in px: depth by its square or faster.
    EXPECT_GT(table[i].least.depth_m, 3.5 * table[i - 1].least.depth_m);
  }
  conditions.noise_grey *= 3;
  const auto noisy = AccuracyOver(d.collar, conditions, {0.1});
  EXPECT_NEAR(noisy[0].least.tip_m / table[1].least.tip_m, 3.0, 0.05);
}

TEST(AccuracyOfACollar, RefusesTooFewPixels) {
  const CollarDesign d = DesignCollar({});
  const double most_m = ReadableTo(d.cell_m, Camera());
  EXPECT_NEAR(most_m, 950 * 0.0006 / 2.5, 1e-9);
  EXPECT_NO_THROW(CheckReadable(d.tag_size_m, d.cell_m, Camera(), most_m));
  try {
    CheckReadable(d.tag_size_m, d.cell_m, Camera(), 0.4);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr("11.4 px wide"),
                                         testing::HasSubstr("within 228 mm"),
                                         testing::HasSubstr("tags of 8.5 mm")));
  }
  EXPECT_THROW(AccuracyOver(d.collar, {.camera = Camera()}, {-0.1}), InputError);
  EXPECT_THROW(AccuracyOver(d.collar, {.camera = Camera(), .noise_grey = 0}, {0.1}), InputError);
}

}  // namespace
}  // namespace flextip
