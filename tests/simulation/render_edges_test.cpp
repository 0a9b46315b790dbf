// Edges of the picture stand where cv::projectPoints puts them, to 0.01 px.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>

#include "core/draw_vector.h"
#include "core/linear_algebra.h"
#include "core/rotation.h"
#include "simulation/render/face.h"
#include "simulation/render/tag_pattern.h"
#include "tests/simulation/render_test_scene.h"

namespace flextip::simulation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using namespace render_test;

struct EdgeErrors {
  int count = 0;
  double sum = 0, squares = 0, worst = 0;
  void Add(double error) {
    ++count;
    sum += error;
    squares += error * error;
    worst = std::max(worst, std::abs(error));
  }
  double Mean() const { return sum / count; }
  double Rms() const { return std::sqrt(squares / count); }
};

// A picture of one number a pixel that may be read with its axes swapped.
struct Field {
  int width = 0, height = 0;
  std::vector<double> value;
  double At(int along, int across, bool swapped) const {
    return swapped ? value[static_cast<std::size_t>(along) * width + across]
                   : value[static_cast<std::size_t>(across) * width + along];
  }
};

// The part of each pixel that is not covered by anything before the tissue: light of a scene over
// bright tissue less that over black tissue, over the bright tissue's own.
Field Uncovered(const CameraCalibration& camera, const TagCollar& collar, LaparoscopeOptions o,
                const ShaftCurve& curve) {
  const Laparoscope bright(camera, collar, o);
  std::vector<Occluder> none;
  std::swap(o.occluders, none);
  const LinearImage alone = Laparoscope(camera, {}, o).RenderLinear(HiddenShaft(), 0);
  std::swap(o.occluders, none);
  o.tissue.albedo_bgr.setZero();
  const LinearImage a = bright.RenderLinear(curve, 0);
  const LinearImage b = Laparoscope(camera, collar, o).RenderLinear(curve, 0);
  Field field{camera.width_px, camera.height_px, {}};
  for (std::size_t i = 0; i < a.data.size(); i += 3) {
    field.value.push_back((a.data[i] - b.data[i]) / alone.data[i]);
  }
  return field;
}

// A straight line v = c0 + c1 (x - x0) through the field at places x0 + from .. x0 + to.
Vector2d FitLevel(const Field& f, int x0, int from, int to, int line, bool swapped) {
  Eigen::Matrix2d N = Eigen::Matrix2d::Zero();
  Vector2d b = Vector2d::Zero();
  for (int d = from; d <= to; ++d) {
    const Vector2d row(1, d);
    N += row * row.transpose();
    b += row * f.At(x0 + d, line, swapped);
  }
  return Ldlt(N).Solve(b);
}

// Where the field steps along a line of pixels, by the area under it: the levels on both sides
// (straight lines fitted there) weigh each pixel between them.
double StepPlace(const Field& f, int near, int line, bool swapped) {
  constexpr int kReach = 4, kFar = 8;
  const Vector2d low = FitLevel(f, near, -kFar, -kReach, line, swapped);
  const Vector2d high = FitLevel(f, near, kReach, kFar, line, swapped);
  double before = 0;
  for (int d = -kReach + 1; d < kReach; ++d) {
    const double l = low[0] + low[1] * d, h = high[0] + high[1] * d;
    before += (f.At(near + d, line, swapped) - h) / (l - h);
  }
  return near - kReach + 0.5 + before;
}

// Compares the field's step with the expected line, a dense chain of pixels, on each row (or
// column, where the line lies rather flat) it crosses.
EdgeErrors CompareEdge(const Field& f, const std::vector<Vector2d>& line) {
  const Vector2d run = (line.back() - line.front()).cwiseAbs();
  const bool swapped = run.x() > run.y();
  const int axis = swapped ? 1 : 0, other = 1 - axis;
  const int along_limit = swapped ? f.height : f.width, line_limit = swapped ? f.width : f.height;
  EdgeErrors errors;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Vector2d &a = line[i], &b = line[i + 1];
    const double low = std::min(a[other], b[other]), high = std::max(a[other], b[other]);
    for (int k = static_cast<int>(std::ceil(low)); k < high; ++k) {
      if (k < 1 || k >= line_limit - 1) continue;
      const double expected =
          a[axis] + (b[axis] - a[axis]) * (k - a[other]) / (b[other] - a[other]);
      const int near = static_cast<int>(std::lround(expected));
      if (near < 10 || near > along_limit - 11) continue;
      const double slope = (b[axis] - a[axis]) / (b[other] - a[other]);
      errors.Add((StepPlace(f, near, k, swapped) - expected) / std::hypot(1.0, slope));
    }
  }
  return errors;
}

std::vector<Vector2d> ProjectSegment(const CameraCalibration& camera, const Vector3d& a,
                                     const Vector3d& b) {
  std::vector<Vector3d> points;
  for (int i = 0; i <= 200; ++i) points.push_back(a + (b - a) * (0.1 + 0.8 * i / 200.0));
  return Project(camera, points);
}

// One of the sides of a square of half side `h` about a tag's middle.
std::vector<Vector2d> SideOfSquare(const CameraCalibration& camera, const Pose& T_CG, double h,
                                   int side) {
  const Vector3d corners[4] = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}};
  return ProjectSegment(camera, T_CG * corners[side], T_CG * corners[(side + 1) % 4]);
}

// A tag of 32 mm that faces the camera, turned and moved by the test's number.
struct TagScene {
  TagCollar collar;
  ShaftCurve curve;
  Pose T_CG;
};
TagScene MakeTagScene(int number) {
  TagScene scene;
  scene.T_CG.R = ExpRotation(
      {0.3 * std::sin(1.0 + number), 0.35 * std::cos(2.0 * number), 0.05 + 0.37 * number});
  scene.T_CG.p = {0.004 * std::sin(3.0 * number), 0.00037 * number, 0.085};
  scene.collar.tags = {{3 + number, 0.032, {}}};
  scene.collar.tags[0].T_EG.R = scene.T_CG.R;  // the shaft's frame E is R, its shaft is hidden
  scene.collar.tags[0].T_EG.p = scene.T_CG.p;
  scene.curve = HiddenShaft();
  scene.curve.T_RE = Pose{};
  return scene;
}

class EdgesUnderEachLens : public testing::TestWithParam<int> {
 protected:
  CameraCalibration camera_ = SmallCameras()[static_cast<std::size_t>(GetParam())];
};

TEST_P(EdgesUnderEachLens, BorderOfATag) {
  for (int number = 0; number < 5; ++number) {
    const TagScene scene = MakeTagScene(number);
    const LinearImage image =
        Laparoscope(camera_, scene.collar, PlainOptions()).RenderLinear(scene.curve, 0);
    Field field{image.width_px, image.height_px, {}};
    for (std::size_t i = 0; i < image.data.size(); i += 3) field.value.push_back(image.data[i]);
    const double h = 0.016;
    for (int side = 0; side < 4; ++side) {
      const EdgeErrors e = CompareEdge(field, SideOfSquare(camera_, scene.T_CG, h, side));
      ASSERT_GT(e.count, 50);
      EXPECT_LT(std::abs(e.Mean()), 0.003) << "tag " << number << " side " << side;
      EXPECT_LT(e.worst, 0.003) << "tag " << number << " side " << side;
    }
  }
}

TEST_P(EdgesUnderEachLens, RimOfAPlate) {
  for (int number = 0; number < 5; ++number) {
    const TagScene scene = MakeTagScene(number);
    const Field field = Uncovered(camera_, scene.collar, PlainOptions(), scene.curve);
    const double h = 0.020;  // the border's half side and a cell of margin
    for (int side = 0; side < 4; ++side) {
      const EdgeErrors e = CompareEdge(field, SideOfSquare(camera_, scene.T_CG, h, side));
      ASSERT_GT(e.count, 50);
      EXPECT_LT(std::abs(e.Mean()), 0.003) << "tag " << number << " side " << side;
      EXPECT_LT(e.Rms(), 0.01) << "tag " << number << " side " << side;
    }
  }
}

// The silhouette of a tube of constant radius about the curve c(s): the points c + r n with n
// across the tangent and across the ray, n . c = -r.
std::vector<Vector3d> Silhouette(const ShaftCurve& curve, double radius_m, double length_m,
                                 double sign) {
  std::vector<Vector3d> points;
  // The arc itself, not the points the renderer is given, and without the round end.
  for (int i = 0; i <= 3000; ++i) {
    const double angle = length_m * (0.9 - 0.75 * i / 3000.0) / radius_m;
    const Vector3d c =
        curve.T_RE * Vector3d(-radius_m * std::sin(angle), radius_m * (1 - std::cos(angle)), 0);
    const Vector3d t = curve.T_RE.R * Vector3d(std::cos(angle), -std::sin(angle), 0);
    const Vector3d across = c - c.dot(t) * t;
    const Vector3d e = across.normalized(), f = t.cross(e);
    const double r = 0.5 * curve.diameter_m, along = -r / across.norm();
    points.push_back(c + r * (along * e + sign * std::sqrt(1 - along * along) * f));
  }
  return points;
}

TEST_P(EdgesUnderEachLens, SilhouetteOfABentShaft) {
  for (int number = 0; number < 4; ++number) {
    Pose T_RE;
    T_RE.R = ExpRotation({0, 0.25 * std::sin(1.0 * number), 0.2 + 0.8 * number});
    T_RE.p = T_RE.R * Vector3d(0.03, -0.0013 * number, 0.002) + Vector3d(0, 0, 0.09);
    const double bend_m = 0.15 + 0.1 * number;
    const ShaftCurve curve = ArcShaft(T_RE, 0.08, bend_m, 0.012);
    const Field field = Uncovered(camera_, {}, PlainOptions(), curve);
    for (const double sign : {-1.0, 1.0}) {
      const EdgeErrors e =
          CompareEdge(field, Project(camera_, Silhouette(curve, bend_m, 0.08, sign)));
      ASSERT_GT(e.count, 60);
      EXPECT_LT(std::abs(e.Mean()), 0.003) << "shaft " << number << " side " << sign;
      EXPECT_LT(e.Rms(), 0.01) << "shaft " << number << " side " << sign;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Lenses, EdgesUnderEachLens, testing::Range(0, 4));

TEST(RenderEdges, TheShaftEndsAtTheTip) {
  // The round end is a sphere that touches E: its outline by the cone of rays that touch it.
  const CameraCalibration camera = SmallCamera();
  Pose T_RE;
  T_RE.p = {0.0107, 0.0021, 0.08};
  const ShaftCurve curve = ArcShaft(T_RE, 0.1, 5.0, 0.012);
  const Field field = Uncovered(camera, {}, PlainOptions(), curve);
  const Vector3d centre = T_RE * Vector3d(-0.006, 0, 0), e = centre.normalized();
  const double sine = 0.006 / centre.norm();
  const Eigen::Matrix<double, 3, 2> basis = NormalBasis(e);
  std::vector<Vector3d> outline;
  for (int i = 0; i <= 20000; ++i) {
    const double angle = 2 * std::numbers::pi * i / 20000;
    const Vector3d across = std::cos(angle) * basis.col(0) + std::sin(angle) * basis.col(1);
    const Vector3d touch = std::sqrt(1 - sine * sine) * e + sine * across;
    if (touch.x() / touch.z() > centre.x() / centre.z() + 0.05) outline.push_back(touch);
  }
  std::sort(outline.begin(), outline.end(),
            [](const Vector3d& a, const Vector3d& b) { return a.y() / a.z() < b.y() / b.z(); });
  const EdgeErrors errors = CompareEdge(field, Project(camera, outline));
  ASSERT_GT(errors.count, 20);
  EXPECT_LT(std::abs(errors.Mean()), 0.005);
}

TEST(RenderEdges, AreaOfTagCellsAgreesWithManyPoints) {
  const TagPattern pattern = MakeTagPattern("tag36h11", 17);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-5.5, 5.5), size(-2.0, 2.0), unit(0, 1);
  for (int trial = 0; trial < 40; ++trial) {
    const Vector2d origin = DrawVector<2>(place, random);
    Vector2d a = DrawVector<2>(size, random), b = DrawVector<2>(size, random);
    const Vector2d quad[4] = {origin, origin + a, origin + a + b, origin + b};
    int white = 0;
    constexpr int kPoints = 40000;
    for (int i = 0; i < kPoints; ++i) {
      const double along_b = unit(random), along_a = unit(random);
      const Vector2d p = origin + along_a * a + along_b * b;
      white += pattern.WhiteAt(p.x(), p.y());
    }
    EXPECT_NEAR(render::WhitePart(pattern, quad), white / static_cast<double>(kPoints), 0.012);
  }
}

}  // namespace
}  // namespace flextip::simulation
