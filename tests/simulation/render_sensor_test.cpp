// Photometry and the camera's sensor, against the formulas they stand for.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include "core/draw_vector.h"
#include "core/error.h"
#include "core/rotation.h"
#include "tests/simulation/render_test_scene.h"

namespace flextip::simulation {
namespace {

using Eigen::Vector3d;
using namespace render_test;

double LightAt(const CameraCalibration& camera, const LaparoscopeOptions& o, int x, int y) {
  return Laparoscope(camera, {}, o).RenderLinear(HiddenShaft(), 0).At(x, y)[1];
}

// A tag on the axis at E = R = camera, and a tissue behind it.
TagCollar TagAt(double distance_m) {
  TagCollar collar;
  collar.tags = {{7, 0.016, {}}};
  collar.tags[0].T_EG.p.z() = distance_m;
  return collar;
}
ShaftCurve TagsOnly() {
  ShaftCurve curve = HiddenShaft();
  curve.T_RE = Pose{};
  return curve;
}

TEST(RenderPhotometry, LightFallsWithTheSquareOfTheDistance) {
  const CameraCalibration camera = SmallCamera();
  LaparoscopeOptions o = PlainOptions();
  o.exposure = 0.8;
  const int x = 161, y = 119;  // 0.3 and 0.4 px off the axis
  for (const double distance_m : {0.05, 0.1, 0.17}) {
    o.tissue.point_R.z() = distance_m;
    EXPECT_NEAR(LightAt(camera, o, x, y), 0.8 * 0.5 * std::pow(0.1 / distance_m, 2), 2e-5);
  }
}

TEST(RenderPhotometry, SurfacesSeenAskewAndOffTheAxisAreDarker) {
  const CameraCalibration camera = SmallCamera();
  LaparoscopeOptions o = PlainOptions();
  o.vignetting = 2.5;
  o.tissue.normal_R = ExpRotation({0.3, -0.4, 0}) * Vector3d(0, 0, -1);
  for (const int x : {20, 150, 300}) {
    const int y = 60;
    const Vector3d ray((x - camera.cu_px) / camera.fu_px, (y - camera.cv_px) / camera.fv_px, 1);
    const Vector3d n = o.tissue.normal_R;
    const Vector3d at = ray * n.dot(o.tissue.point_R) / n.dot(ray);
    const double lambert = -n.dot(at) / at.norm(), axis = at.z() / at.norm();
    const double expected =
        o.exposure * 0.5 * 0.01 / at.squaredNorm() * lambert * std::pow(axis, 2.5);
    EXPECT_NEAR(LightAt(camera, o, x, y) / expected, 1.0, 1e-4);
  }
}

TEST(RenderPhotometry, ExposureIsMetAtTheTissueWhereNoDistanceIsGiven) {
  LaparoscopeOptions o = PlainOptions();
  o.exposure_distance_m = 0;
  o.tissue.point_R = {0.01, 0.02, 0.13};
  EXPECT_NEAR(LightAt(SmallCamera(), o, 161, 119), o.exposure * 0.5, 2e-5);
}

TEST(RenderSensor, NoiseHasTheMeanAndTheVarianceOfShotAndReadNoise) {
  LaparoscopeOptions o = PlainOptions();
  o.full_well_electrons = 4000;
  o.read_noise_electrons = 40;
  for (const double albedo : {0.05, 0.4}) {
    o.tissue.albedo_bgr.setConstant(albedo);
    o.exposure = 1.8;
    o.tissue.point_R.z() = 0.12;
    const Laparoscope scope(SmallCamera(), {}, o);
    const LinearImage light = scope.RenderLinear(HiddenShaft(), 0);
    double n = 0, sum = 0, squares = 0, neighbours = 0, frames = 0, expected = 0;
    Image before;
    for (int frame = 0; frame < 6; ++frame) {
      const Image image = scope.Render(HiddenShaft(), frame);
      const auto rest = [&](const Image& i, std::size_t k) {
        return i.data[k] - 255.0 * light.data[k];
      };
      for (std::size_t k = 0; k + 3 < image.data.size(); ++k) {
        const double r = rest(image, k), s = light.data[k];
        n += 1;
        sum += r;
        squares += r * r;
        neighbours += r * rest(image, k + 1) + r * rest(image, k + 3);
        if (!before.Empty()) frames += r * rest(before, k);
        // 8-bit rounding adds 1/12.
        expected += 255.0 * 255.0 * (s / 4000 + std::pow(40 / 4000.0, 2)) + 1 / 12.0;
      }
      before = image;
    }
    const double variance = expected / n;
    EXPECT_LT(std::abs(sum / n), 5 * std::sqrt(variance / n) + 0.002) << albedo;
    EXPECT_NEAR(squares / expected, 1.0, 5 * std::sqrt(2 / n) + 0.002) << albedo;
    EXPECT_LT(std::abs(neighbours / n / variance), 10 / std::sqrt(n)) << albedo;
    EXPECT_LT(std::abs(frames / n / variance), 5 / std::sqrt(n)) << albedo;
  }
}

TEST(RenderSensor, GammaEncodesLinearLightAndTheCalibrationGoesFirst) {
  CameraCalibration camera = SmallCamera();
  LaparoscopeOptions o = PlainOptions();
  o.tissue.normal_R = ExpRotation({0, 1.0, 0}) * Vector3d(0, 0, -1);  // a ramp of light
  o.exposure = 6;
  for (const auto& [of_camera, of_options, expected] :
       {std::tuple{std::optional<double>{}, 2.2, 2.2},
        {std::optional{1.0}, 2.2, 1.0},
        {std::optional{1.8}, 1.0, 1.8}}) {
    camera.gamma = of_camera;
    o.gamma = of_options;
    const Laparoscope scope(camera, {}, o);
    EXPECT_EQ(scope.Gamma(), expected);
    const LinearImage light = scope.RenderLinear(HiddenShaft(), 0);
    const Image image = scope.Render(HiddenShaft(), 0);
    int darkest = 255, brightest = 0;
    for (std::size_t k = 0; k < image.data.size(); ++k) {
      const double code = 255 * std::pow(std::min<double>(light.data[k], 1.0), 1 / expected);
      ASSERT_NEAR(image.data[k], code, 0.51);
      darkest = std::min<int>(darkest, image.data[k]);
      brightest = std::max<int>(brightest, image.data[k]);
    }
    EXPECT_LT(darkest, 128);
    EXPECT_EQ(brightest, 255) << "the ramp was to reach the full well";
  }
}

TEST(RenderSensor, BlurIsAGaussianOverTheLinearLight) {
  LaparoscopeOptions o = PlainOptions();
  o.exposure = 0.9;
  o.blur_sigma_px = 1.3;
  const Laparoscope scope(SmallCamera(), TagAt(0.1), o);
  const LinearImage light = scope.RenderLinear(TagsOnly(), 0);
  const Image image = scope.Render(TagsOnly(), 0);
  int changed = 0;
  for (int y = 80; y < 160; y += 3) {
    for (int x = 120; x < 200; x += 3) {
      double sum = 0, weights = 0;
      for (int dy = -8; dy <= 8; ++dy) {
        for (int dx = -8; dx <= 8; ++dx) {
          const double weight = std::exp(-0.5 * (dx * dx + dy * dy) / (1.3 * 1.3));
          weights += weight;
          sum += weight * light.At(x + dx, y + dy)[1];
        }
      }
      EXPECT_NEAR(image.Row(y)[3 * x + 1], 255 * sum / weights, 0.6);
      changed += std::abs(image.Row(y)[3 * x + 1] - 255 * light.At(x, y)[1]) > 3;
    }
  }
  EXPECT_GT(changed, 100);
}

TEST(RenderSensor, TheSameSeedGivesTheSameBytesOnAnyNumberOfThreads) {
  LaparoscopeOptions o;
  o.tissue.point_R = {0.2, 0, -0.045};
  CameraCalibration camera = SampleCamera();
  camera.width_px = 320;
  camera.height_px = 180;
  camera.fu_px = camera.fv_px = 240;
  camera.cu_px = 161;
  camera.cv_px = 88;
  Pose T_RE;
  T_RE.p = {0.2, 0, 0};
  const ShaftCurve curve = ArcShaft(T_RE, 0.3, 1.0, 0.005);
  const Laparoscope scope(camera, HexagonCollar(), o);
  const Image image = scope.Render(curve, 3);
  EXPECT_EQ(image.data, scope.Render(curve, 3).data);
  EXPECT_NE(image.data, scope.Render(curve, 4).data);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(image.data, Laparoscope(camera, HexagonCollar(), o).Render(curve, 3).data);
  }
  o.seed = 2;
  EXPECT_NE(image.data, Laparoscope(camera, HexagonCollar(), o).Render(curve, 3).data);
}

TEST(RenderSensor, AnOccluderHidesWhatIsBehindItInItsFramesAlone) {
  const CameraCalibration camera = SmallCamera();
  LaparoscopeOptions o = PlainOptions();
  const LinearImage free = Laparoscope(camera, TagAt(0.1), o).RenderLinear(TagsOnly(), 5);
  for (const Occluder::Kind kind : {Occluder::Kind::kCapsule, Occluder::Kind::kDisc}) {
    Occluder blood;
    blood.kind = kind;
    blood.a_R = {0, 0, 0.07};
    blood.b_R = kind == Occluder::Kind::kDisc ? Vector3d(0, 0, 0) : Vector3d(0.02, 0, 0.07);
    blood.radius_m = 0.004;
    blood.albedo_bgr = {0, 0, 0.2};
    blood.specular = 0;
    blood.first_frame = 5;
    blood.last_frame = 6;
    blood.velocity_R = {0, 0.012, 0};
    o.occluders = {blood};
    const Laparoscope scope(camera, TagAt(0.1), o);
    const int x = 161, y = 119;
    EXPECT_EQ(scope.RenderLinear(TagsOnly(), 4).data, free.data);
    EXPECT_EQ(scope.RenderLinear(TagsOnly(), 7).data, free.data);
    const LinearImage hidden = scope.RenderLinear(TagsOnly(), 5);
    EXPECT_EQ(hidden.At(x, y)[0], 0);
    EXPECT_GT(hidden.At(x, y)[2], 0);
    EXPECT_EQ(hidden.At(x, y - 30)[0], free.At(x, y - 30)[0]);
    const LinearImage moved = scope.RenderLinear(TagsOnly(), 6);  // 12 mm down at 70 mm: 51 px
    EXPECT_EQ(moved.At(x, y)[0], free.At(x, y)[0]);
    EXPECT_EQ(moved.At(x, y + 51)[0], 0);
  }
}

TEST(RenderSensor, WhatIsBehindTheTagStaysHidden) {
  // A capsule farther than the tag changes nothing within the tag's outline.
  const CameraCalibration camera = SmallCamera();
  LaparoscopeOptions o = PlainOptions();
  const LinearImage free = Laparoscope(camera, TagAt(0.1), o).RenderLinear(TagsOnly(), 0);
  Occluder behind;
  behind.a_R = {-0.03, 0, 0.12};
  behind.b_R = {0.03, 0, 0.12};
  o.occluders = {behind};
  const LinearImage with = Laparoscope(camera, TagAt(0.1), o).RenderLinear(TagsOnly(), 0);
  EXPECT_EQ(with.At(161, 119)[1], free.At(161, 119)[1]);
  EXPECT_NE(with.At(161 + 60, 119)[1], free.At(161 + 60, 119)[1]);
}

TEST(RenderSensor, GreyIsTheLuminanceOfTheColours) {
  LaparoscopeOptions o = PlainOptions();
  o.tissue.albedo_bgr = {0.1, 0.3, 0.7};
  const float* bgr = nullptr;
  const LinearImage colour = Laparoscope(SmallCamera(), {}, o).RenderLinear(HiddenShaft(), 0);
  bgr = colour.At(100, 100);
  o.grey = true;
  const Laparoscope scope(SmallCamera(), {}, o);
  const LinearImage grey = scope.RenderLinear(HiddenShaft(), 0);
  ASSERT_EQ(grey.channels, 1);
  EXPECT_NEAR(grey.At(100, 100)[0], 0.0722 * bgr[0] + 0.7152 * bgr[1] + 0.2126 * bgr[2], 1e-6);
  EXPECT_EQ(scope.Render(HiddenShaft(), 0).channels, 1);
}

TEST(RenderInput, AnyShaftGivesFiniteLight) {
  // Across the camera, through it, along its axis, behind it, with points that coincide.
  CameraCalibration camera = SmallCamera();
  camera.distortion_coefficients = {-0.22, 0.08, 0.0006, -0.0004};
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 60; ++trial) {
    LaparoscopeOptions o = PlainOptions();
    camera.width_px = camera.height_px = 96;
    camera.cu_px = camera.cv_px = 47.5;
    Pose T_RE;
    T_RE.R = ExpRotation(2.0 * DrawVector<3>(normal, random));
    T_RE.p = 0.03 * (Vector3d(0, 0, 1) + DrawVector<3>(normal, random));
    if (trial == 0) T_RE.R << 0, 1, 0, 0, 0, 1, 1, 0, 0;  // along the optical axis
    if (trial == 0) T_RE.p = {0, 0, 0.1};
    ShaftCurve curve = ArcShaft(T_RE, 0.3, 0.05 + 0.01 * trial, 0.005);
    curve.points.insert(curve.points.begin() + 7, curve.points[7]);
    Occluder capsule;
    capsule.a_R = 0.05 * DrawVector<3>(normal, random);
    capsule.b_R = trial == 1 ? Vector3d(-capsule.a_R) : Vector3d(0.01, 0.02, 0.05);
    o.occluders = {capsule};
    const LinearImage image = Laparoscope(camera, HexagonCollar(), o).RenderLinear(curve, 0);
    ASSERT_TRUE(std::all_of(image.data.begin(), image.data.end(), [](float v) {
      return std::isfinite(v) && v >= 0;
    })) << trial;
  }
}

TEST(RenderInput, BadInputIsRefused) {
  const CameraCalibration camera = SmallCamera();
  TagCollar collar = TagAt(0.1);
  collar.family = "tag99h9";
  EXPECT_THROW(Laparoscope(camera, collar, PlainOptions()), InputError);
  collar = TagAt(0.1);
  collar.tags[0].id = 587;  // tag36h11 has 587 tags, from 0
  EXPECT_THROW(Laparoscope(camera, collar, PlainOptions()), InputError);
  collar.tags[0] = {1, -0.005, {}};
  EXPECT_THROW(Laparoscope(camera, collar, PlainOptions()), InputError);
  CameraCalibration wrong = camera;
  wrong.distortion_coefficients = {0.1, 0.1, 0.1};
  EXPECT_THROW(Laparoscope(wrong, {}, PlainOptions()), InputError);
  wrong = camera;
  wrong.height_px = 0;
  EXPECT_THROW(Laparoscope(wrong, {}, PlainOptions()), InputError);
  LaparoscopeOptions options = PlainOptions();
  options.exposure = std::nan("");
  EXPECT_THROW(Laparoscope(camera, {}, options), InputError);
  options = PlainOptions();
  options.tissue.normal_R.setZero();
  EXPECT_THROW(Laparoscope(camera, {}, options), InputError);
}

// The grid on which the lens blurs changes neither a pixel's light nor, where no lens blurs, what
// falls on the film.
TEST(RenderLens, AFinerGridHasTheSameLightInAPixel) {
  const CameraCalibration camera = SmallCamera();
  LaparoscopeOptions o = PlainOptions();
  o.blur_sigma_px = 0;
  const LinearImage plain = Laparoscope(camera, TagAt(0.1), o).RenderLinear(TagsOnly(), 0);
  o.parts_per_px = 3;
  const Laparoscope fine(camera, TagAt(0.1), o);
  const LinearImage means = fine.RenderLinear(TagsOnly(), 0);
  ASSERT_EQ(means.data.size(), plain.data.size());
  for (std::size_t i = 0; i < plain.data.size(); ++i) {
    ASSERT_NEAR(means.data[i], plain.data[i], 2e-3) << i;
  }
  EXPECT_EQ(fine.RenderLight(TagsOnly(), 0).data, means.data);
  o.parts_per_px = 5;
  EXPECT_THROW(Laparoscope(camera, TagAt(0.1), o), InputError);
}

// A blurred edge of a tag on the axis is the normal distribution, averaged over each pixel,
// wherever in its pixel the edge lies; blurred after the pixels it is not.
TEST(RenderLens, BlursBeforeThePixelsTakeTheirMeans) {
  constexpr double kSigma_px = 0.6, kDistance_m = 0.1;
  LaparoscopeOptions o = PlainOptions();
  o.blur_sigma_px = kSigma_px;
  const auto largest_error = [&](int parts) {
    o.parts_per_px = parts;
    double largest = 0;
    for (const double offset_px : {0.0, 0.3, 0.5, 0.8}) {
      CameraCalibration camera = SmallCamera();
      camera.cu_px += offset_px;
      const LinearImage light =
          Laparoscope(camera, TagAt(kDistance_m), o).RenderLight(TagsOnly(), 0);
      // The tag's outer black border toward -x, on a row through its middle.
      const double edge_px = camera.cu_px - camera.fu_px * 0.008 / kDistance_m;
      const int y = static_cast<int>(std::lround(camera.cv_px));
      const int first = static_cast<int>(std::lround(edge_px)) - 3;
      const double white = light.At(first - 1, y)[1], black = light.At(first + 7, y)[1];
      for (int x = first; x <= first + 6; ++x) {
        double mean = 0;
        for (int k = 0; k < 100; ++k) {
          const double at = x - 0.5 + (k + 0.5) / 100;
          mean += 0.5 * std::erfc((at - edge_px) / kSigma_px / std::sqrt(2.0)) / 100;
        }
        const double part = (light.At(x, y)[1] - black) / (white - black);
        largest = std::max(largest, std::abs(part - mean));
      }
    }
    return largest;
  };
  EXPECT_LT(largest_error(4), 0.01);  // of the contrast
  EXPECT_GT(largest_error(1), 0.03);
}

}  // namespace
}  // namespace flextip::simulation
