// Virtual fixtures against exact projections, and the mesh against a search of all its triangles.
#include "control/virtual_fixture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "allocation_counter.h"
#include "control/virtual_fixture_mesh.h"
#include "core/error.h"
#include "core/linear_algebra.h"

namespace flextip {
namespace {

using Eigen::Vector3d;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Vector3d Random(std::mt19937_64& rng, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  const double x = uniform(rng), y = uniform(rng), z = uniform(rng);
  return {x, y, z};
}

/// A unit sphere's icosahedron, each triangle divided `times` times; corners moved by `shape`.
template <class Shape>
TriangleMesh Ball(int times, const Shape& shape) {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  TriangleMesh mesh;
  mesh.points = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                 {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Vector3d& p : mesh.points) p.normalize();
  const auto middle = [&mesh](int a, int b) {
    const Vector3d p = (mesh.points[a] + mesh.points[b]).normalized();
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      if ((mesh.points[i] - p).norm() < 1e-9) return static_cast<int>(i);
    }
    mesh.points.push_back(p);
    return static_cast<int>(mesh.points.size()) - 1;
  };
  for (int i = 0; i < times; ++i) {
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
  }
  for (Vector3d& p : mesh.points) p = shape(p);
  return mesh;
}

TriangleMesh Sphere(int times) {
  return Ball(times, [](const Vector3d& p) -> Vector3d { return 0.05 * p; });
}
/// With hollows.
TriangleMesh Organ() {
  return Ball(3, [](const Vector3d& p) -> Vector3d {
    return (0.05 + 0.012 * std::sin(4.0 * p.x()) * std::cos(5.0 * p.y() + p.z())) * p;
  });
}

TriangleMesh Cube() {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) mesh.points.emplace_back(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// The nearest place on a triangle by minimising over its inside, its edges and its corners.
double DistanceToTriangle(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                          const Vector3d& p) {
  Eigen::Matrix<double, 3, 2> sides;
  sides << b - a, c - a;
  const Eigen::Vector2d uv = Ldlt(sides.transpose() * sides).Solve(sides.transpose() * (p - a));
  if (uv.minCoeff() >= 0.0 && uv.sum() <= 1.0) return (a + sides * uv - p).norm();
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [u, v] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    const double part = std::clamp((p - u).dot(v - u) / (v - u).squaredNorm(), 0.0, 1.0);
    least = std::min(least, (u + part * (v - u) - p).norm());
  }
  return least;
}

double DistanceToMesh(const TriangleMesh& mesh, const Vector3d& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.triangles) {
    least = std::min(least, DistanceToTriangle(mesh.points[a], mesh.points[b], mesh.points[c], p));
  }
  return least;
}

/// How often the surface winds around a point, by the solid angles of its triangles (van Oosterom).
bool IsInside(const TriangleMesh& mesh, const Vector3d& p) {
  double angle = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vector3d a = mesh.points[t[0]] - p, b = mesh.points[t[1]] - p, c = mesh.points[t[2]] - p;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    angle +=
        2.0 * std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return angle > 2.0 * std::acos(-1.0);
}

TEST(VirtualFixture, HalfSpaceProjectsOntoItsPlane) {
  std::mt19937_64 rng(1);
  for (int i = 0; i < 1000; ++i) {
    const ForbiddenHalfSpace region{Random(rng, 0.1), Random(rng, 1.0).normalized()};
    const Vector3d p = Random(rng, 0.2);
    const double margin = i % 2 == 0 ? 0.0 : 0.01;
    const FixtureOutput out = Constrain(region, p, margin);
    const double height = region.normal.dot(p - region.p_plane);
    EXPECT_NEAR(out.depth_m, -height, 1e-15);
    if (height >= margin) {
      EXPECT_EQ(out.status, FixtureStatus::kFree);
      EXPECT_EQ(out.p_RE_desired, p);
      continue;
    }
    EXPECT_EQ(out.status, FixtureStatus::kMoved);
    // On the plane that is the margin away, and moved along the normal alone.
    EXPECT_NEAR(region.normal.dot(out.p_RE_desired - region.p_plane), margin, 1e-15);
    EXPECT_LT((out.p_RE_desired - p).cross(region.normal).norm(), 1e-15);
  }
}

TEST(VirtualFixture, SphereFromInsideAndOutside) {
  std::mt19937_64 rng(2);
  for (int i = 0; i < 1000; ++i) {
    ForbiddenSphere region{Random(rng, 0.1), 0.05, i % 3 == 0};
    const Vector3d p = region.p_centre + Random(rng, 0.08);
    const double distance = (p - region.p_centre).norm(), margin = i % 2 == 0 ? 0.0 : 0.005;
    const FixtureOutput out = Constrain(region, p, margin);
    const double side = region.forbidden_outside ? -1.0 : 1.0;
    const double allowed = 0.05 + side * margin;
    const bool free = side * (distance - allowed) >= 0.0;
    EXPECT_NEAR(out.depth_m, side * (0.05 - distance), 1e-15);
    EXPECT_EQ(out.status, free ? FixtureStatus::kFree : FixtureStatus::kMoved);
    const Vector3d expected =
        free ? p : Vector3d(region.p_centre + allowed / distance * (p - region.p_centre));
    EXPECT_LT((out.p_RE_desired - expected).norm(), 1e-15);
  }
  const ForbiddenSphere region{{1, 2, 3}, 0.5, false};
  EXPECT_LT((Constrain(region, region.p_centre).p_RE_desired - Vector3d(1, 2, 3.5)).norm(), 1e-15);
  const ForbiddenSphere narrow{{0, 0, 0}, 0.01, true};
  const FixtureOutput out = Constrain(narrow, {0.003, 0, 0}, 0.02);
  EXPECT_EQ(out.status, FixtureStatus::kNotClear);
  EXPECT_EQ(out.p_RE_desired, narrow.p_centre);
}

TEST(VirtualFixture, BadInputIsHandedBack) {
  const ForbiddenHalfSpace plane;
  const ForbiddenSphere sphere{{0, 0, 0}, 0.05, false};
  const ForbiddenMesh mesh(Cube());
  const PathGuidance path({{0, 0, 0}, {1, 0, 0}});
  const Vector3d bad(0.0, kNaN, 0.0), good(0.01, 0.0, 0.0);
  EXPECT_EQ(Constrain(plane, bad).status, FixtureStatus::kBadInput);
  EXPECT_EQ(Constrain(sphere, bad).status, FixtureStatus::kBadInput);
  EXPECT_EQ(mesh.Constrain(bad).status, FixtureStatus::kBadInput);
  EXPECT_EQ(path.Guide(bad).status, FixtureStatus::kBadInput);
  for (const double margin : {-1e-3, kNaN, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(Constrain(plane, good, margin).status, FixtureStatus::kBadInput);
    EXPECT_EQ(Constrain(sphere, good, margin).p_RE_desired, good);
    EXPECT_EQ(mesh.Constrain(good, margin).status, FixtureStatus::kBadInput);
  }
}

TEST(VirtualFixture, MeshAgreesWithASearchOfAllTriangles) {
  const TriangleMesh organ = Organ();
  const ForbiddenMesh fixture(organ);
  ASSERT_EQ(fixture.TriangleCount(), 1280);
  std::mt19937_64 rng(3);
  int inside_count = 0;
  for (int i = 0; i < 1500; ++i) {
    Vector3d p = Random(rng, 0.07);
    // Some exactly above corners and edges, where inside and outside are hardest to tell.
    if (i % 5 == 0) p = (i % 2 == 0 ? 1.02 : 0.98) * organ.points[i % organ.points.size()];
    const double distance = DistanceToMesh(organ, p);
    const bool inside = IsInside(organ, p);
    inside_count += inside;
    const MeshPlace place = fixture.Nearest(p);
    EXPECT_NEAR(place.distance_m, distance, 1e-13);
    EXPECT_NEAR((place.p - p).norm(), distance, 1e-13);
    EXPECT_NEAR(place.normal.norm(), 1.0, 1e-12);
    const FixtureOutput out = fixture.Constrain(p);
    EXPECT_NEAR(out.depth_m, inside ? distance : -distance, 1e-13);
    EXPECT_EQ(out.status, inside ? FixtureStatus::kMoved : FixtureStatus::kFree);
    EXPECT_LT(DistanceToMesh(organ, out.p_RE_desired) * inside, 1e-13);
  }
  EXPECT_GT(inside_count, 200);
  EXPECT_LT(inside_count, 1300);
}

TEST(VirtualFixture, MeshKeepsItsMarginInHollows) {
  const TriangleMesh organ = Organ();
  const double margin = 0.002;
  std::mt19937_64 rng(4);
  for (const bool outside : {false, true}) {
    const ForbiddenMesh fixture(organ, outside);
    int moved = 0;
    for (int i = 0; i < 500; ++i) {
      const Vector3d p = Random(rng, 0.06);
      const FixtureOutput out = fixture.Constrain(p, margin);
      if (out.status == FixtureStatus::kFree) {
        EXPECT_EQ(out.p_RE_desired, p);
      } else {
        ASSERT_EQ(out.status, FixtureStatus::kMoved);
        ++moved;
      }
      EXPECT_GE(DistanceToMesh(organ, out.p_RE_desired), margin - 2e-9);
      EXPECT_EQ(IsInside(organ, out.p_RE_desired), outside);
    }
    EXPECT_GT(moved, 100);
  }
}

TEST(VirtualFixture, FineMeshOfASphereTendsToTheSphere) {
  const ForbiddenSphere sphere{{0, 0, 0}, 0.05, false};
  std::mt19937_64 rng(5);
  double worst[2] = {0.0, 0.0};
  for (int finer = 0; finer < 2; ++finer) {
    const ForbiddenMesh mesh(Sphere(2 + finer));
    for (int i = 0; i < 500; ++i) {
      Vector3d p = Random(rng, 0.06);
      if (p.norm() < 0.02) continue;  // near the centre the nearest place is any
      worst[finer] = std::max(worst[finer],
                              std::abs(mesh.Constrain(p).depth_m - Constrain(sphere, p).depth_m));
    }
  }
  EXPECT_LT(worst[0], 0.05 * 0.02);
  EXPECT_NEAR(worst[0] / worst[1], 4.0, 0.8);  // the gap between chord and arc
}

TEST(VirtualFixture, CubesEdgesAndCorners) {
  const ForbiddenMesh cube(Cube());
  EXPECT_NEAR(cube.Constrain({1.1, 1.1, 0.5}).depth_m, -0.1 * std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(cube.Constrain({-0.1, -0.1, -0.1}).depth_m, -0.1 * std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(cube.Constrain({0.5, 0.5, 0.9}).depth_m, 0.1, 1e-15);
  const FixtureOutput on = cube.Constrain({0.5, 0.5, 1.0}, 0.25);  // on the face itself
  EXPECT_LT((on.p_RE_desired - Vector3d(0.5, 0.5, 1.25)).norm(), 1e-14);
  // No room for so wide a margin inside the cube.
  EXPECT_EQ(ForbiddenMesh(Cube(), true).Constrain({0.4, 0.5, 0.5}, 0.7).status,
            FixtureStatus::kNotClear);
}

TEST(VirtualFixture, MeshesThatBoundNothingAreRefused) {
  TriangleMesh open = Cube();
  open.triangles.pop_back();
  EXPECT_THROW(ForbiddenMesh{open}, InputError);
  TriangleMesh turned = Cube();
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_THROW(ForbiddenMesh{turned}, InputError);
  TriangleMesh flat = Cube();
  flat.triangles[0] = {0, 0, 1};
  EXPECT_THROW(ForbiddenMesh{flat}, InputError);
  TriangleMesh beyond = Cube();
  beyond.triangles[0][0] = 8;
  EXPECT_THROW(ForbiddenMesh{beyond}, InputError);
  TriangleMesh infinite = Cube();
  infinite.points[3].x() = kNaN;
  EXPECT_THROW(ForbiddenMesh{infinite}, InputError);
  EXPECT_THROW(ForbiddenMesh{TriangleMesh()}, InputError);
}

TEST(VirtualFixture, PathGuidesAcrossAndFreesAlong) {
  // A screw, so that no two places are alike.
  std::vector<Vector3d> points;
  for (int i = 0; i < 40; ++i) {
    points.emplace_back(0.03 * std::cos(0.2 * i), 0.03 * std::sin(0.2 * i), 0.002 * i);
  }
  const PathGuidance hard(points), soft(points, 0.25), tube(points, 0.25, 0.004);
  std::mt19937_64 rng(6);
  for (int i = 0; i < 500; ++i) {
    const Vector3d p = Random(rng, 0.05) + Vector3d(0, 0, 0.04);
    double nearest = std::numeric_limits<double>::infinity();
    Vector3d place = p;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      for (int j = 0; j <= 200; ++j) {  // every 0.03 mm
        const Vector3d q = points[k] + j / 200.0 * (points[k + 1] - points[k]);
        if ((q - p).norm() < nearest) nearest = (q - p).norm(), place = q;
      }
    }
    const GuidanceOutput out = hard.Guide(p);
    EXPECT_LE(out.distance_m, nearest + 1e-15);
    EXPECT_GT(out.distance_m, nearest - 1e-5);
    EXPECT_LT((out.p_RE_desired - out.p_path).norm(), 1e-15);
    EXPECT_NEAR((p - out.p_path).norm(), out.distance_m, 1e-15);
    EXPECT_LT((soft.Guide(p).p_RE_desired - (out.p_path + 0.25 * (p - out.p_path))).norm(), 1e-15);
    const GuidanceOutput in_tube = tube.Guide(p);
    if (out.distance_m <= 0.004) {
      EXPECT_EQ(in_tube.status, FixtureStatus::kFree);
      EXPECT_EQ(in_tube.p_RE_desired, p);
    } else {
      EXPECT_NEAR((in_tube.p_RE_desired - out.p_path).norm(),
                  0.004 + 0.25 * (out.distance_m - 0.004), 1e-15);
    }
  }
  // Along the path nothing is changed, and the place is known.
  const Vector3d on = 0.5 * (points[7] + points[8]);
  const GuidanceOutput out = hard.Guide(on);
  EXPECT_LT((out.p_RE_desired - on).norm(), 1e-15);
  EXPECT_NEAR(out.s_m, 7.5 * (points[1] - points[0]).norm(), 1e-14);
  EXPECT_NEAR(out.tangent.dot((points[8] - points[7]).normalized()), 1.0, 1e-12);
  EXPECT_NEAR(hard.Length(), 39 * (points[1] - points[0]).norm(), 1e-13);
}

TEST(VirtualFixture, PathsThatLeadNowhereAreRefused) {
  EXPECT_THROW(PathGuidance({{0, 0, 0}}), InputError);
  EXPECT_THROW(PathGuidance({{0, 0, 0}, {0, 0, 0}}), InputError);
  EXPECT_THROW(PathGuidance({{0, 0, 0}, {kNaN, 0, 0}}), InputError);
  EXPECT_THROW(PathGuidance({{0, 0, 0}, {1, 0, 0}}, 1.5), InputError);
  EXPECT_THROW(PathGuidance({{0, 0, 0}, {1, 0, 0}}, 0.5, -1.0), InputError);
}

TEST(VirtualFixture, AStepAllocatesNothing) {
  const ForbiddenMesh mesh(Organ());
  const PathGuidance path({{0, 0, 0}, {0.1, 0, 0}, {0.1, 0.1, 0}});
  const ForbiddenHalfSpace plane;
  const ForbiddenSphere sphere{{0, 0, 0}, 0.05, false};
  std::mt19937_64 rng(7);
  std::vector<Vector3d> places;
  for (int i = 0; i < 100; ++i) places.push_back(Random(rng, 0.06));
  const long before = AllocationCount();
  double sum = 0.0;
  for (const Vector3d& p : places) {
    sum += mesh.Constrain(p, 0.002).depth_m + path.Guide(p).distance_m +
           Constrain(plane, p).depth_m + Constrain(sphere, p).depth_m;
  }
  EXPECT_EQ(AllocationCount(), before);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace flextip
