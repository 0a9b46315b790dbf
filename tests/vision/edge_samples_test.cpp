// Pixels drawn along a tag's edges, against the edges themselves.
#include "vision/photometric/edge_samples.h"

#include <gtest/gtest.h>

#include <set>

#include "core/pose.h"
#include "core/rotation.h"
#include "vision/tags/cells.h"

namespace flextip {
namespace {

constexpr double kCell_m = 0.0005;
constexpr double kReach_cells = 0.15;

CameraCalibration Camera(double first_distortion) {
  CameraCalibration c;
  c.width_px = 320;
  c.height_px = 260;
  c.fu_px = 1700;
  c.fv_px = 1690;
  c.cu_px = 160.3;
  c.cv_px = 128.8;
  c.distortion_coefficients = {first_distortion, 0, 0, 0};
  return c;
}

// A tag of 200 px, drawn.
struct Drawn {
  explicit Drawn(const Eigen::Vector3d& turn, double first_distortion = 0)
      : camera(Camera(first_distortion)), lens(camera), cells(ReadTagCells("tag36h11", 3)) {
    std::fill(image.data.begin(), image.data.end(), std::uint8_t{128});
    T_CG = {ExpRotation(turn), {0.0002, -0.0003, 0.045}};
    const double half = 0.5 * cells.cells;
    Eigen::Matrix3d from_tag;
    from_tag << kCell_m * T_CG.R.col(0), kCell_m * T_CG.R.col(1),
        T_CG.p - half * kCell_m * (T_CG.R.col(0) + T_CG.R.col(1));
    region.to_tag = from_tag.inverse().cast<float>();
    region.x0 = region.y0 = 0;
    region.x1 = image.width_px - 1;
    region.y1 = image.height_px - 1;
    const auto end = static_cast<float>(cells.cells);
    region.limits = {0, end, 0, end};
    region.unknown_u = region.unknown_v = 0.4f;
    region.edge_u = region.edge_v = static_cast<float>(kReach_cells);
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d x_G((i - 1) * half * kCell_m, (j - 1) * half * kCell_m, 0);
        region.places_px[j][i] = *camera.Project(T_CG * x_G);
      }
    }
  }

  // The places on the tag, in cells, of what was drawn.
  std::vector<Eigen::Vector2d> Places(int samples, int flat_samples) {
    region.samples = samples;
    region.flat_samples = flat_samples;
    FacePixels pixels;
    SampleEdges(region, BlurredPattern(cells), lens, image, pixels);
    std::vector<Eigen::Vector2d> places;
    for (const FacePixels::Found& p : pixels.found) {
      const Eigen::Vector3d at = region.to_tag.cast<double>() * Eigen::Vector3d(p.x, p.y, 1);
      places.emplace_back(at.head<2>() / at.z());
      rays.emplace(p.x, p.y);
      EXPECT_EQ(p.grey, 128);
    }
    return places;
  }

  // The distance of a place from the nearest cell's side between black and white (cells).
  double FromEdge(const Eigen::Vector2d& at) const {
    double nearest = HUGE_VAL;
    for (int k = 0; k < cells.cells; ++k) {
      for (int l = 0; l < cells.cells; ++l) {
        const auto distance = [&](double u0, double v0, double u1, double v1) {
          const double du = std::max({u0 - at.x(), 0.0, at.x() - u1});
          const double dv = std::max({v0 - at.y(), 0.0, at.y() - v1});
          return std::hypot(du, dv);
        };
        if (k > 0 && cells.At(k, l) != cells.At(k - 1, l)) {
          nearest = std::min(nearest, distance(k, l, k, l + 1));
        }
        if (l > 0 && cells.At(k, l) != cells.At(k, l - 1)) {
          nearest = std::min(nearest, distance(k, l, k + 1, l));
        }
      }
    }
    return nearest;
  }

  CameraModel camera;
  LensMap lens;
  TagCells cells;
  Image image{320, 260, 1};
  Pose T_CG;
  TagRegion region{};
  std::set<std::pair<float, float>> rays;
};

constexpr double kPixel_cells = 0.06;  // half of one's diagonal, at 11 to 20 px a cell

TEST(EdgeSamples, LieAtEdgesAndAreDrawnOnce) {
  for (const double distortion : {0.0, -0.3}) {
    Drawn tag({0.3, -0.4, 0.5}, distortion);
    const auto places = tag.Places(1500, 0);
    EXPECT_GT(places.size(), 1050u);
    EXPECT_LE(places.size(), 1500u);
    EXPECT_EQ(tag.rays.size(), places.size());
    for (const auto& at : places) EXPECT_LT(tag.FromEdge(at), kReach_cells + kPixel_cells);
  }
}

TEST(EdgeSamples, OfFlatPixelsAreAwayFromEdges) {
  Drawn tag({0.3, -0.4, 0.5});
  const auto places = tag.Places(0, 400);
  EXPECT_GE(places.size(), 300u);
  EXPECT_LE(places.size(), 400u + 8u);
  for (const auto& at : places) EXPECT_GT(tag.FromEdge(at), kReach_cells - kPixel_cells);
}

// Both sides of every edge, and edges in proportion to their number in each quarter of the tag.
TEST(EdgeSamples, LieEvenly) {
  Drawn tag({0, 0, 0.5});
  const auto places = tag.Places(2000, 0);
  const double middle = 0.5 * tag.cells.cells;
  double edges = 0, within = 0, white = 0;
  for (int k = 1; k < tag.cells.cells; ++k) {
    for (int l = 1; l < tag.cells.cells; ++l) {
      const bool quarter = k < middle && l < middle;
      for (const bool edge : {tag.cells.At(k, l) != tag.cells.At(k - 1, l),
                              tag.cells.At(k, l) != tag.cells.At(k, l - 1)}) {
        edges += edge;
        within += edge && quarter;
      }
    }
  }
  double found = 0;
  for (const auto& at : places) {
    found += at.x() < middle && at.y() < middle;
    white += tag.cells.At(static_cast<int>(at.x()), static_cast<int>(at.y())) == TagCells::kWhite;
  }
  const auto all = static_cast<double>(places.size());
  EXPECT_NEAR(found / all, within / edges, 0.03);
  EXPECT_NEAR(white / all, 0.5, 0.03);
}

TEST(EdgeSamples, OfATagOutsideThePictureAreNone) {
  Drawn tag({0, 0, 0.5});
  tag.region.x0 = tag.image.width_px;
  EXPECT_TRUE(tag.Places(500, 100).empty());
}

}  // namespace
}  // namespace flextip
