#include "control/virtual_fixture_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "core/error.h"
#include "core/place.h"

namespace flextip {
namespace {

constexpr int kLeaf = 4;      // triangles
constexpr int kDeepest = 64;  // halving leaves no more levels than an int has bits
constexpr int kMoves = 8;     // to keep a margin in a hollow
constexpr double kClear_m = 1e-9;

double AngleAt(const Eigen::Vector3d& corner, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d u = a - corner, v = b - corner;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace

/// A place on a triangle and the part of it that it is on.
struct ForbiddenMesh::Feature {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  int corner = -1, edge = -1;  // both -1: inside the triangle
};

ForbiddenMesh::ForbiddenMesh(TriangleMesh mesh, bool forbidden_outside)
    : mesh_(std::move(mesh)), forbidden_outside_(forbidden_outside) {
  CheckTriangles();
  ComputeNormals();
  order_.resize(mesh_.triangles.size());
  std::iota(order_.begin(), order_.end(), 0);
  Build(0, static_cast<int>(order_.size()));
}

void ForbiddenMesh::CheckTriangles() const {
  if (mesh_.triangles.empty()) throw InputError("a mesh without triangles bounds nothing");
  const int points = static_cast<int>(mesh_.points.size());
  for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
    const auto& t = mesh_.triangles[i];
    for (const int corner : t) {
      if (corner < 0 || corner >= points) {
        throw InputError(
            fmt::format("triangle {} names corner {}, there are {}", i, corner, points));
      }
      if (!IsPlace(mesh_.points[corner])) {
        throw InputError(fmt::format("corner {} of the mesh is not finite, or farther than {:g} m",
                                     corner, kFarthestPlace_m));
      }
    }
    const Eigen::Vector3d u = mesh_.points[t[1]] - mesh_.points[t[0]];
    const Eigen::Vector3d v = mesh_.points[t[2]] - mesh_.points[t[0]];
    if (!(u.cross(v).norm() > 1e-12 * u.norm() * v.norm()) || u.cross(v).norm() == 0.0) {
      throw InputError(fmt::format("triangle {} of the mesh has no area", i));
    }
  }
}

/// Of the triangles, of the edges (both neighbours) and of the corners (weighted by the angles).
void ForbiddenMesh::ComputeNormals() {
  const std::size_t count = mesh_.triangles.size();
  face_normals_.resize(count);
  edge_normals_.resize(count);
  corner_normals_.assign(mesh_.points.size(), Eigen::Vector3d::Zero());
  std::map<std::pair<int, int>, int> owner;  // of a directed edge
  for (std::size_t i = 0; i < count; ++i) {
    const auto& t = mesh_.triangles[i];
    const auto& P = mesh_.points;
    face_normals_[i] = (P[t[1]] - P[t[0]]).cross(P[t[2]] - P[t[0]]).normalized();
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      corner_normals_[a] += AngleAt(P[a], P[b], P[c]) * face_normals_[i];
      if (!owner.emplace(std::pair(a, b), static_cast<int>(i)).second) {
        throw InputError(fmt::format(
            "the mesh's edge from corner {} to {} is in two triangles turned against each other", a,
            b));
      }
    }
  }
  for (const auto& [edge, triangle] : owner) {
    const auto other = owner.find({edge.second, edge.first});
    if (other == owner.end()) {
      throw InputError(fmt::format("the mesh is open at its edge from corner {} to {}", edge.first,
                                   edge.second));
    }
    const auto& t = mesh_.triangles[triangle];
    const auto k = std::find(t.begin(), t.end(), edge.first) - t.begin();
    edge_normals_[triangle][k] =
        (face_normals_[triangle] + face_normals_[other->second]).normalized();
  }
  for (Eigen::Vector3d& normal : corner_normals_) normal.normalize();
}

/// Halves the triangles along the longest side of their box; returns the box's index.
int ForbiddenMesh::Build(int first, int count) {
  const auto centre = [this](int triangle, int axis) {
    const auto& t = mesh_.triangles[triangle];
    return mesh_.points[t[0]][axis] + mesh_.points[t[1]][axis] + mesh_.points[t[2]][axis];
  };
  Box node;
  for (int i = first; i < first + count; ++i) {
    for (const int corner : mesh_.triangles[order_[i]]) node.box.extend(mesh_.points[corner]);
  }
  const int index = static_cast<int>(boxes_.size());
  node.first = first;
  if (count <= kLeaf) node.count = count;
  boxes_.push_back(node);
  if (count <= kLeaf) return index;
  int axis = 0;
  node.box.sizes().maxCoeff(&axis);
  const int half = count / 2;
  std::nth_element(order_.begin() + first, order_.begin() + first + half,
                   order_.begin() + first + count,
                   [&](int a, int b) { return centre(a, axis) < centre(b, axis); });
  Build(first, half);
  const int right = Build(first + half, count - half);
  boxes_[index].right = right;
  return index;
}

/// Ericson's regions of a triangle (Real-Time Collision Detection, 5.1.5).
ForbiddenMesh::Feature ForbiddenMesh::NearestOnTriangle(int triangle,
                                                        const Eigen::Vector3d& p) const noexcept {
  const auto& t = mesh_.triangles[triangle];
  const Eigen::Vector3d &a = mesh_.points[t[0]], &b = mesh_.points[t[1]], &c = mesh_.points[t[2]];
  const Eigen::Vector3d ab = b - a, ac = c - a;
  const double d1 = ab.dot(p - a), d2 = ac.dot(p - a);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, 0, -1};
  const double d3 = ab.dot(p - b), d4 = ac.dot(p - b);
  if (d3 >= 0.0 && d4 <= d3) return {b, 1, -1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {a + d1 / (d1 - d3) * ab, -1, 0};
  const double d5 = ab.dot(p - c), d6 = ac.dot(p - c);
  if (d6 >= 0.0 && d5 <= d6) return {c, 2, -1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {a + d2 / (d2 - d6) * ac, -1, 2};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {b + w * (c - b), -1, 1};
  }
  const double sum = va + vb + vc;
  return {a + vb / sum * ab + vc / sum * ac, -1, -1};
}

MeshPlace ForbiddenMesh::Nearest(const Eigen::Vector3d& p) const noexcept {
  MeshPlace best;
  Feature feature;
  double best2 = std::numeric_limits<double>::infinity();
  int open[kDeepest], count = 0;
  open[count++] = 0;
  while (count > 0) {
    const int index = open[--count];
    const Box& node = boxes_[index];
    if (node.box.squaredExteriorDistance(p) >= best2) continue;
    if (node.count == 0) {
      // The nearer one is looked at first: it is put on top.
      const int left = index + 1, right = node.right;
      const bool left_nearer = boxes_[left].box.squaredExteriorDistance(p) <=
                               boxes_[right].box.squaredExteriorDistance(p);
      open[count++] = left_nearer ? right : left;
      open[count++] = left_nearer ? left : right;
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const Feature tried = NearestOnTriangle(order_[i], p);
      const double distance2 = (tried.p - p).squaredNorm();
      if (distance2 >= best2) continue;
      best2 = distance2;
      feature = tried;
      best.triangle = order_[i];
    }
  }
  best.p = feature.p;
  best.distance_m = std::sqrt(best2);
  if (feature.corner >= 0) {
    best.normal = corner_normals_[mesh_.triangles[best.triangle][feature.corner]];
  } else if (feature.edge >= 0) {
    best.normal = edge_normals_[best.triangle][feature.edge];
  } else {
    best.normal = face_normals_[best.triangle];
  }
  return best;
}

/// Of the point in the forbidden region.
double ForbiddenMesh::SignedDepth(const Eigen::Vector3d& p, const MeshPlace& place) const noexcept {
  const bool inside = place.normal.dot(p - place.p) < 0.0;
  return inside != forbidden_outside_ ? place.distance_m : -place.distance_m;
}

FixtureOutput ForbiddenMesh::Constrain(const Eigen::Vector3d& p, double margin_m) const noexcept {
  if (!IsPlace(p) || !(margin_m >= 0.0 && margin_m <= kFarthestPlace_m)) {
    return {FixtureStatus::kBadInput, p, 0.0, Eigen::Vector3d::Zero()};
  }
  FixtureOutput output{FixtureStatus::kFree, p, 0.0, Eigen::Vector3d::Zero()};
  for (int move = 0; move <= kMoves; ++move) {
    const Eigen::Vector3d& now = output.p_RE_desired;
    const MeshPlace place = Nearest(now);
    const double depth = SignedDepth(now, place);
    // Out of the region: from the surface's nearest place through the point, or back through it.
    Eigen::Vector3d normal = forbidden_outside_ ? Eigen::Vector3d(-place.normal) : place.normal;
    if (place.distance_m > kClear_m) {
      normal = (depth > 0.0 ? place.p - now : now - place.p) / place.distance_m;
    }
    if (move == 0) {
      output.depth_m = depth;
      output.normal = normal;
    }
    if (depth <= -margin_m + kClear_m) return output;
    output.status = move == kMoves ? FixtureStatus::kNotClear : FixtureStatus::kMoved;
    if (move < kMoves) output.p_RE_desired = place.p + margin_m * normal;
    if (margin_m == 0.0) return output;
  }
  return output;
}

}  // namespace flextip
