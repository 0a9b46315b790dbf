// The tube's outline against its surface, point by point, and its derivatives against differences.
#include "vision/outline/tube_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/rotation.h"
#include "tests/simulation/render_test_scene.h"
#include "vision/tags/reprojection.h"

namespace flextip {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Scene {
  TubeShape tube;
  Pose T_CE;
  Vector2d bend;
};

// Tubes across the picture, toward the camera and away from it, with round and flat ends.
std::vector<Scene> Scenes() {
  std::vector<Scene> scenes;
  for (int i = 0; i < 6; ++i) {
    Scene scene;
    scene.tube.diameter_m = 0.006;
    scene.tube.length_m = 0.08;
    scene.tube.round_end = i % 2 == 0;
    scene.T_CE.R = ExpRotation({0, 0.3 * (i - 2.5), 0}) * ExpRotation({0, 0, 0.5 + 0.9 * i}) *
                   ExpRotation({0.7 * i, 0, 0});
    scene.T_CE.p = Vector3d(0.004 * std::sin(i), 0.003 * std::cos(i), 0.08) +
                   scene.T_CE.R * Vector3d(0.01, 0, 0);
    scene.bend = {40.0 * std::cos(2.0 * i), 40.0 * std::sin(3.0 * i)};
    scenes.push_back(scene);
  }
  return scenes;
}

// Pixels of many points of the tube's surface.
std::vector<Vector2d> Surface(const CameraModel& camera, const Scene& scene) {
  const double r = 0.5 * scene.tube.diameter_m;
  std::vector<Vector2d> pixels;
  const auto add = [&](const Vector3d& x_E) {
    if (const auto px = camera.Project(scene.T_CE * x_E)) pixels.push_back(*px);
  };
  constexpr int kAlong = 500, kAround = 500;
  for (int j = 0; j < kAround; ++j) {
    const double angle = 2 * std::numbers::pi * j / kAround;
    for (int i = 0; i <= kAlong; ++i) {
      const double first = scene.tube.round_end ? r : 0.0;
      const CentreLinePoint at =
          TubeCentre(scene.bend, first + (scene.tube.length_m - first) * i / kAlong);
      const Vector3d y = Vector3d::UnitZ().cross(at.t_E).normalized(), z = at.t_E.cross(y);
      add(at.x_E + r * (std::cos(angle) * y + std::sin(angle) * z));
    }
    for (int i = 0; scene.tube.round_end && i <= 100; ++i) {
      const double up = 0.5 * std::numbers::pi * i / 100;
      add({-r + r * std::sin(up), r * std::cos(up) * std::cos(angle),
           r * std::cos(up) * std::sin(angle)});
    }
  }
  return pixels;
}

class TubeOutline : public testing::TestWithParam<int> {
 protected:
  CameraModel camera_{render_test::SmallCameras()[static_cast<std::size_t>(GetParam())]};
};

TEST_P(TubeOutline, NothingOfTheSurfaceStandsOutsideAndSomethingTouches) {
  for (const Scene& scene : Scenes()) {
    const auto surface = Surface(camera_, scene);
    const auto points = TubeContour(camera_, scene.tube, scene.T_CE, scene.bend, 12, 9);
    ASSERT_GT(points.size(), 18u);
    for (const ContourPoint& p : points) {
      const Vector2d along(-p.outward.y(), p.outward.x());
      double furthest = -1e9;
      for (const Vector2d& px : surface) {
        if (std::abs(along.dot(px - p.px)) > 0.4) continue;
        const double out = p.outward.dot(px - p.px);
        if (out < 3 * p.radius_px) furthest = std::max(furthest, out);
      }
      EXPECT_NEAR(furthest, 0.0, 0.02) << static_cast<int>(p.part) << " at " << p.place;
    }
  }
}

// How far outward from p.px along p.outward the dense outline `line` (of the same part) is met.
double Crossing(const ContourPoint& p, const std::vector<ContourPoint>& line) {
  const Vector2d along(-p.outward.y(), p.outward.x());
  double met = NAN;
  const ContourPoint* last = nullptr;
  for (const ContourPoint& q : line) {
    if (q.part != p.part) continue;
    if (last) {
      const double a = along.dot(last->px - p.px), b = along.dot(q.px - p.px);
      const double at = p.outward.dot(last->px + (q.px - last->px) * a / (a - b) - p.px);
      if (a * b <= 0 && a != b && !(std::abs(at) > std::abs(met))) met = at;
    }
    last = &q;
  }
  return met;
}

TEST_P(TubeOutline, DerivativesAreThoseOfTheMovedOutline) {
  for (const Scene& scene : Scenes()) {
    const auto outline = [&](const Eigen::Matrix<double, 8, 1>& step) {
      Scene moved = scene;
      moved.T_CE = MovePose(scene.T_CE, step.head<6>());
      moved.bend += step.segment<2>(6);
      return TubeContour(camera_, moved.tube, moved.T_CE, moved.bend, 400, 300);
    };
    const auto points = TubeContour(camera_, scene.tube, scene.T_CE, scene.bend, 8, 7);
    Eigen::Matrix<double, 8, 1> size;  // moves of some tenths of a pixel
    size << 0.004, 0.004, 0.004, 1e-4, 1e-4, 1e-4, 3, 3;
    for (int k = 0; k < 8; ++k) {
      const Eigen::Matrix<double, 8, 1> step = size[k] * Eigen::Matrix<double, 8, 1>::Unit(k);
      const auto ahead = outline(step), back = outline(-step);
      int compared = 0;
      for (const ContourPoint& p : points) {
        const double out = 0.5 * (Crossing(p, ahead) - Crossing(p, back));
        if (std::isnan(out)) continue;  // it has left the picture
        Eigen::Matrix<double, 1, 8> J;
        J << p.J_pose, p.J_bend;
        EXPECT_NEAR(J * step, out, 0.004) << k << " part " << static_cast<int>(p.part);
        ++compared;
      }
      EXPECT_GT(compared, 14);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, TubeOutline, testing::Range(0, 4));

TEST(TubeCentre, IsTheIntegralOfItsCurvature) {
  const Vector2d bend(9, -6);  // 0.12 rad at 0.15 m
  Vector2d across = Vector2d::Zero();
  double back = 0;
  constexpr int kSteps = 20000;
  const double length = 0.15, ds = length / kSteps;
  for (int i = 0; i < kSteps; ++i) {  // the angle grows as s^2 / 2 in a fixed plane
    const double s = (i + 0.5) * ds, angle = 0.5 * s * s * bend.norm();
    back += std::cos(angle) * ds;
    across += std::sin(angle) * ds * bend.normalized();
  }
  const CentreLinePoint at = TubeCentre(bend, length);
  // What is left out next: s angle^4 / 216.
  EXPECT_NEAR(at.x_E.x(), -back, length * std::pow(0.5 * length * length * bend.norm(), 4) / 200);
  EXPECT_NEAR(at.x_E.y(), across.x(), 2e-8);
  EXPECT_NEAR(at.x_E.z(), across.y(), 2e-8);
  const double angle = 0.5 * length * length * bend.norm();
  EXPECT_NEAR(at.t_E.x(), std::cos(angle), 1e-5);
}

TEST(TubeOutlineCollar, LeavesOutWhatACollarMayCover) {
  const CameraModel camera(render_test::SmallCamera());
  Scene scene = Scenes()[2];
  scene.tube.collar = TubeShape::Collar{-0.03, -0.02, 0.007};
  const auto all = TubeContour(camera, Scenes()[2].tube, scene.T_CE, scene.bend, 30, 9);
  const auto rest = TubeContour(camera, scene.tube, scene.T_CE, scene.bend, 30, 9);
  EXPECT_LT(rest.size(), all.size());
  // The pictures of the collar's rings, some pixels to spare.
  std::vector<Vector2d> ring;
  for (int i = 0; i < 2000; ++i) {
    const double x = -0.03 + 0.01 * (i % 20) / 19.0, a = 2 * std::numbers::pi * i / 2000;
    ring.push_back(
        *camera.Project(scene.T_CE * Vector3d(x, 0.007 * std::cos(a), 0.007 * std::sin(a))));
  }
  for (const ContourPoint& p : rest) {
    for (const Vector2d& px : ring) ASSERT_GT((px - p.px).norm(), 2.0);
  }
}

// What the renderer draws of a collar lies within the body that its tags' sizes tell.
TEST(TubeOutlineCollar, KnowsTheBodyFromTheTags) {
  const CameraCalibration camera = render_test::SmallCamera();
  for (const char* family : {"tag36h11", "tagStandard41h12"}) {
    TagCollar collar = render_test::HexagonCollar();
    collar.family = family;
    const TubeShape tube = TubeOf(collar, 0.005, true);
    EXPECT_EQ(tube.diameter_m, 0.005);
    const simulation::Laparoscope with(camera, collar, render_test::PlainOptions());
    const simulation::Laparoscope without(camera, {}, render_test::PlainOptions());
    const Pose T_CE{ExpRotation({0, M_PI + 0.3, 0}), {-0.02, 0.002, 0.06}};
    const simulation::ShaftCurve shaft = render_test::ArcShaft(T_CE, 0.15, 1e3, 0.005);
    const simulation::LinearImage a = with.RenderLinear(shaft, 0),
                                  b = without.RenderLinear(shaft, 0);
    std::vector<Vector2d> collar_px;
    for (int y = 0; y < a.height_px; ++y) {
      for (int x = 0; x < a.width_px; ++x) {
        if (a.At(x, y)[0] != b.At(x, y)[0]) collar_px.emplace_back(x, y);
      }
    }
    ASSERT_GT(collar_px.size(), 500U);
    const auto points = TubeContour(CameraModel(camera), tube, T_CE, {0, 0}, 40, 9);
    ASSERT_GT(points.size(), 40U) << family;
    for (const ContourPoint& p : points) {
      for (const Vector2d& px : collar_px) ASSERT_GT((px - p.px).norm(), 2.0) << family;
    }
  }
}

}  // namespace
}  // namespace flextip
