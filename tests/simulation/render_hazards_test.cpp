// What hides a tip in rendered frames, against the formulas and the places it stands for.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/rotation.h"
#include "simulation/render/tag_pattern.h"
#include "tests/simulation/render_test_scene.h"
#include "vision/tags/detector.h"

namespace flextip::simulation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using namespace render_test;

constexpr double kTag_m = 0.016;

// One tag, G's axes those of E; the camera is at R.
TagCollar OneTag(int id = 7) { return {"tag36h11", {{id, kTag_m, {}}}}; }

ShaftCurve TagAt(const Pose& T_RE) {
  ShaftCurve curve = HiddenShaft();
  curve.T_RE = T_RE;
  return curve;
}
ShaftCurve TagInFront(double depth_m = 0.1, const Vector3d& turn = Vector3d::Zero()) {
  return TagAt({ExpRotation(turn), {0, 0, depth_m}});
}

// The nearest pixel to a point of E.
std::array<int, 2> PixelOf(const Pose& T_RE, const Vector3d& x_E) {
  const Vector2d px = Project(SmallCamera(), {T_RE * x_E})[0];
  return {static_cast<int>(std::lround(px.x())), static_cast<int>(std::lround(px.y()))};
}

LinearImage Linear(const LaparoscopeOptions& o, const ShaftCurve& curve, int frame) {
  return Laparoscope(SmallCamera(), OneTag(), o).RenderLinear(curve, frame);
}

TEST(RenderHazards, EvenSmokeMixesInItsOwnLightInItsFramesAlone) {
  LaparoscopeOptions o = PlainOptions();
  const LinearImage clear = Linear(o, TagInFront(), 4);
  Smoke smoke{{3, 5}, 0.4, {0.1, 0.2, 0.3}, 0.0, 50, 0};
  o.hazards.smoke = {smoke};
  const LinearImage veiled = Linear(o, TagInFront(), 4);
  for (std::size_t i = 0; i < clear.data.size(); ++i) {
    const double light = smoke.light_bgr[static_cast<Eigen::Index>(i % 3)];
    ASSERT_NEAR(veiled.data[i], 0.4 * clear.data[i] + 0.6 * light, 1e-6);
  }
  EXPECT_EQ(Linear(o, TagInFront(), 2).data, clear.data);
  EXPECT_EQ(Linear(o, TagInFront(), 6).data, clear.data);
}

TEST(RenderHazards, UnevenSmokeHasOneTransmissionForAllColoursBetweenItsBoundsAndDrifts) {
  LaparoscopeOptions o = PlainOptions();
  const LinearImage clear = Linear(o, HiddenShaft(), 0);
  o.hazards.smoke = {{{}, 0.5, {0.5, 0.02, 0.9}, 0.8, 40, 8}};
  const LinearImage veiled = Linear(o, HiddenShaft(), 0), later = Linear(o, HiddenShaft(), 1);
  const auto t = [&](const LinearImage& image, int x, int y, int c) {
    const double light = o.hazards.smoke[0].light_bgr[c];
    return (image.At(x, y)[c] - light) / (clear.At(x, y)[c] - light);
  };
  double low = 1, high = 0;
  for (int y = 2; y < 238; y += 7) {
    for (int x = 12; x < 310; x += 7) {
      ASSERT_NEAR(t(veiled, x, y, 0), t(veiled, x, y, 2), 1e-4);
      ASSERT_NEAR(t(veiled, x, y, 1), t(veiled, x, y, 2), 1e-4);
      ASSERT_NEAR(t(later, x, y, 1), t(veiled, x - 8, y, 1), 1e-4);
      low = std::min(low, t(veiled, x, y, 1));
      high = std::max(high, t(veiled, x, y, 1));
    }
  }
  EXPECT_GT(low, std::pow(0.5, 1.8));
  EXPECT_LT(high, std::pow(0.5, 0.2));
  EXPECT_GT(high - low, 0.15);
}

TEST(RenderHazards, DefocusAddsItsVarianceToTheLens) {
  LaparoscopeOptions o = PlainOptions(), wide = o;
  o.blur_sigma_px = 0.8;
  o.hazards.defocus = {{{10, 12}, 2.0}};  // at its height in frame 11
  wide.blur_sigma_px = std::hypot(0.8, 2.0);
  const Laparoscope scope(SmallCamera(), OneTag(), o), reference(SmallCamera(), OneTag(), wide);
  EXPECT_EQ(scope.Render(TagInFront(), 11).data, reference.Render(TagInFront(), 11).data);
  wide.blur_sigma_px = std::hypot(0.8, 2.0 * std::sin(std::numbers::pi / 6));
  const Laparoscope half(SmallCamera(), OneTag(), wide);
  EXPECT_EQ(scope.Render(TagInFront(), 10).data, half.Render(TagInFront(), 10).data);
  o.hazards.defocus.clear();
  const Laparoscope sharp(SmallCamera(), OneTag(), o);
  EXPECT_EQ(scope.Render(TagInFront(), 13).data, sharp.Render(TagInFront(), 13).data);
}

// An edge that moves evenly by d during the exposure is a ramp of width d in linear light.
TEST(RenderHazards, MotionBlurTurnsAnEdgeIntoARamp) {
  LaparoscopeOptions o = PlainOptions();
  const Laparoscope scope(SmallCamera(), OneTag(), o);
  constexpr int kInstants = 40;
  constexpr double kWay_px = 5;
  std::vector<ShaftCurve> during;
  for (int i = 0; i < kInstants; ++i) {
    ShaftCurve curve = TagInFront();
    curve.T_RE.p.x() = (i + 0.5) / kInstants * kWay_px * 0.1 / SmallCamera().fu_px;
    during.push_back(curve);
  }
  const Image moved = scope.Render(during, 0), still = scope.Render(TagInFront(), 0);
  const auto [right, y] = PixelOf(TagInFront().T_RE, {0.5 * kTag_m, 0, 0});  // black to white
  const double black = still.Row(y)[3 * (right - 3)], white = still.Row(y)[3 * (right + 2)];
  ASSERT_GT(white - black, 50);
  const double edge = Project(SmallCamera(), {{0.5 * kTag_m, 0, 0.1}})[0].x();
  for (int x = right - 2; x <= right + 4; ++x) {  // the margin's own end starts 6 px from the edge
    double part = 0;  // white until the edge passes, mean over the pixel's width
    for (int k = 0; k < 100; ++k) {
      part += std::clamp((x - 0.5 + (k + 0.5) / 100 - edge) / kWay_px, 0.0, 1.0) / 100;
    }
    EXPECT_NEAR(moved.Row(y)[3 * x], black + (white - black) * part, 2.0) << x - edge;
  }
}

TEST(RenderHazards, TheMeanOfTheExposureIsTakenInLinearLight) {
  LaparoscopeOptions o = PlainOptions();
  CameraCalibration camera = SmallCamera();
  camera.gamma = 2.2;
  const Laparoscope scope(camera, OneTag(), o);
  const std::array<ShaftCurve, 2> curves = {TagInFront(), TagInFront(0.1, {0, 0, 0.4})};
  const Image both = scope.Render(curves, 0);
  const LinearImage a = scope.RenderLinear(curves[0], 0), b = scope.RenderLinear(curves[1], 0);
  for (std::size_t i = 0; i < both.data.size(); ++i) {
    ASSERT_NEAR(both.data[i], 255 * std::pow(0.5 * (a.data[i] + b.data[i]), 1 / 2.2), 0.51);
  }
}

TEST(RenderHazards, AnExposureStepScalesLightAndSettles) {
  LaparoscopeOptions o = PlainOptions();
  const LinearImage before = Linear(o, TagInFront(), 0);
  o.hazards.exposure_steps = {{{5, 20}, 1.6, 4}};
  for (const int frame : {4, 5, 9, 21}) {
    const bool in = frame >= 5 && frame <= 20;
    const double factor = in ? 1 + 0.6 * std::exp(-(frame - 5) / 4.0) : 1.0;
    const LinearImage image = Linear(o, TagInFront(), frame);
    for (std::size_t i = 0; i < image.data.size(); i += 37) {
      ASSERT_NEAR(image.data[i], factor * before.data[i], 1e-6);
    }
  }
}

TEST(RenderHazards, AStainCoversItsPlaceOnTheTagMovesWithItAndEndsAtTheFace) {
  LaparoscopeOptions o = PlainOptions();
  Stain stain{{2, 3}, 7, {0.004, -0.003}, 0.003, {0.0, 0.0, 0.3}, 1.0};
  o.hazards.stains = {stain};
  for (const Vector3d& turn : {Vector3d(0, 0, 0), Vector3d(0.3, -0.4, 0.9)}) {
    const ShaftCurve curve = TagInFront(0.1, turn);
    const LinearImage image = Linear(o, curve, 2), clean = Linear(o, curve, 1);
    const auto [x, y] = PixelOf(curve.T_RE, {0.004, -0.003, 0});
    EXPECT_EQ(image.At(x, y)[0], 0);
    EXPECT_GT(image.At(x, y)[2], 0.01);
    const auto [away_x, away_y] = PixelOf(curve.T_RE, {-0.004, 0.003, 0});
    EXPECT_EQ(image.At(away_x, away_y)[1], clean.At(away_x, away_y)[1]);
    EXPECT_NE(image.data, clean.data);
    EXPECT_EQ(Linear(o, curve, 4).data, clean.data);
  }
  o.hazards.stains[0].centre_m = {0.5 * kTag_m, 0};
  o.hazards.stains[0].radius_m = 0.009;  // far beyond the plate, which is 10 mm wide to each side
  const LinearImage image = Linear(o, TagInFront(), 2), clean = Linear(o, TagInFront(), 1);
  const auto [x, y] = PixelOf(TagInFront().T_RE, {0.0104, 0, 0});
  EXPECT_EQ(image.At(x, y)[1], clean.At(x, y)[1]);
  const auto [in_x, in_y] = PixelOf(TagInFront().T_RE, {0.0096, 0, 0});
  EXPECT_NE(image.At(in_x, in_y)[1], clean.At(in_x, in_y)[1]);
}

TEST(RenderHazards, AThinStainMixesItsColourWithTheCells) {
  LaparoscopeOptions o = PlainOptions();
  o.hazards.stains = {{{}, 7, {0, 0}, 0.02, {0.1, 0.2, 0.3}, 0.25}};
  const LinearImage image = Linear(o, TagInFront(), 0);
  o.hazards.stains.clear();
  const LinearImage clean = Linear(o, TagInFront(), 0);
  // The light on the face: white print of reflectance 0.87 (green) in the margin.
  const auto [mx, my] = PixelOf(TagInFront().T_RE, {0.009, 0.001, 0});
  const auto [bx, by] = PixelOf(TagInFront().T_RE, {0.007, 0.001, 0});
  const double light = clean.At(mx, my)[1] / 0.87;
  EXPECT_NEAR(image.At(mx, my)[1], light * (0.75 * 0.87 + 0.25 * 0.2), 1e-3 * light);
  EXPECT_NEAR(image.At(bx, by)[1] - 0.75 * clean.At(bx, by)[1], light * 0.25 * 0.2, 1e-3 * light);
}

// The light is at the camera: a highlight lies where the bulged surface faces it.
TEST(RenderHazards, GlossPutsAHighlightWhereTheSurfaceFacesTheCamera) {
  LaparoscopeOptions o = PlainOptions();
  const ShaftCurve curve = TagInFront(0.1, {0.25, -0.2, 0});
  const LinearImage matt = Linear(o, curve, 0);
  o.hazards.gloss = {{{}, 1.0, 100}};
  const LinearImage image = Linear(o, curve, 0);
  double best = -1;
  Vector3d facing_E = Vector3d::Zero();
  for (double x = -0.009; x <= 0.009; x += 1e-4) {
    for (double y = -0.009; y <= 0.009; y += 1e-4) {
      const Vector3d n = curve.T_RE.R * Vector3d(100 * x, 100 * y, -1).normalized();
      const double cosine = -n.dot((curve.T_RE * Vector3d(x, y, 0)).normalized());
      if (cosine > best) {
        best = cosine;
        facing_E = {x, y, 0};
      }
    }
  }
  ASSERT_GT(best, 0.999);
  ASSERT_LT(facing_E.head<2>().cwiseAbs().maxCoeff(), 0.008);
  Vector2d centroid = Vector2d::Zero();
  double sum = 0, most = 0;
  for (int y = 0; y < image.height_px; ++y) {
    for (int x = 0; x < image.width_px; ++x) {
      const double more = image.At(x, y)[1] - matt.At(x, y)[1];
      most = std::max(most, more);
      if (more < 0.12) continue;
      centroid += more * Vector2d(x, y);
      sum += more;
    }
  }
  EXPECT_GT(most, 0.15);
  EXPECT_LT((centroid / sum - Project(SmallCamera(), {curve.T_RE * facing_E})[0]).norm(), 2.0);
}

TEST(RenderHazards, AMirroredPrintHasItsCellsLeftForRight) {
  LaparoscopeOptions o = PlainOptions();
  o.hazards.mirrored_tags = {7};
  const LinearImage image = Linear(o, TagInFront(), 0);
  const TagPattern pattern = MakeTagPattern("tag36h11", 7);
  const double cell_m = kTag_m / pattern.border_cells;
  int differ = 0;
  for (int row = 0; row < pattern.cells; ++row) {
    for (int column = 0; column < pattern.cells; ++column) {
      const double half = 0.5 * (pattern.cells - 1);
      const auto [x, y] =
          PixelOf(TagInFront().T_RE, {(column - half) * cell_m, (row - half) * cell_m, 0});
      const bool white = pattern.WhiteAt(half - column, row - half);
      EXPECT_EQ(image.At(x, y)[1] > 0.15, white) << row << ' ' << column;
      differ += white != pattern.WhiteAt(column - half, row - half);
    }
  }
  EXPECT_GT(differ, 10);
}

TEST(RenderHazards, AnotherInstrumentShowsItsTagsWhereItMoves) {
  LaparoscopeOptions o = PlainOptions();
  o.tissue.albedo_bgr.setConstant(0.2);
  OtherInstrument other;
  other.frames = {1, 9};
  other.collar = OneTag(30);
  other.curve = TagInFront();
  other.curve.T_RE.p.x() = -0.03;
  other.velocity_R = {0, 0.004, 0};
  o.hazards.others = {other};
  const Laparoscope scope(SmallCamera(), OneTag(), o);
  ShaftCurve own = TagInFront();
  own.T_RE.p.x() = 0.02;
  TagDetector detector;
  EXPECT_EQ(detector.Detect(scope.Render(own, 0)).size(), 1u);
  const auto tags = detector.Detect(scope.Render(own, 3));
  ASSERT_EQ(tags.size(), 2u);
  EXPECT_EQ(tags[0].id, 7);
  ASSERT_EQ(tags[1].id, 30);
  const double h = 0.5 * kTag_m;
  const Vector2d corner = Project(SmallCamera(), {{-0.03 - h, 0.008 + h, 0.1}})[0];
  EXPECT_LT((tags[1].corners_px[0] - corner).norm(), 0.1);
}

TEST(RenderHazards, OptionsOutOfRangeAreRefused) {
  const auto refused = [](auto change) {
    LaparoscopeOptions o = PlainOptions();
    change(o.hazards);
    EXPECT_THROW(Laparoscope(SmallCamera(), OneTag(), o), InputError);
  };
  refused([](Hazards& h) { h.smoke = {{{}, 0.0}}; });
  refused([](Hazards& h) { h.smoke = {{{}, 0.5, {0, 0, 0}, 1.5}}; });
  refused([](Hazards& h) { h.defocus = {{{0, 3}, -1.0}}; });
  refused([](Hazards& h) { h.exposure_steps = {{{}, 0.0}}; });
  refused([](Hazards& h) { h.stains = {{{}, 7, {0, 0}, -1.0}}; });
  refused([](Hazards& h) { h.stains.resize(17); });
}

}  // namespace
}  // namespace flextip::simulation
