// A virtual fixture whose forbidden region is bounded by a triangle mesh: an organ's surface from
// an image.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "control/virtual_fixture.h"

namespace flextip {

/// Corners in R (m) and triangles of three corners each, anticlockwise seen from outside.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 3>> triangles;
};

/// The place on a mesh nearest to a point.
struct MeshPlace {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  double distance_m = 0.0;
  int triangle = -1;
  /// Unit, outward: of the triangle, or at an edge or corner the mean that tells inside from
  /// outside (Baerentzen and Aanaes 2005).
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// Forbidden: the inside of a closed mesh, or all but its inside.
class ForbiddenMesh {
 public:
  /// Throws InputError where a corner is not finite or not there, a triangle has no area, or the
  /// mesh is not closed with all triangles turned the same way.
  explicit ForbiddenMesh(TriangleMesh mesh, bool forbidden_outside = false);

  /// Constrains as the functions of that name in virtual_fixture.h. In hollows the margin may take
  /// several moves; there are eight at most.
  FixtureOutput Constrain(const Eigen::Vector3d& p, double margin_m = 0.0) const noexcept;

  /// Returns the nearest place by a tree of boxes; at worst looks at every triangle. `p` within
  /// kFarthestPlace_m.
  MeshPlace Nearest(const Eigen::Vector3d& p) const noexcept;

  int TriangleCount() const { return static_cast<int>(mesh_.triangles.size()); }

 private:
  struct Box {
    Eigen::AlignedBox3d box;
    int first = 0, count = 0;  // leaf: triangles order_[first ...]; otherwise count is 0
    int right = 0;             // the left child follows its parent
  };
  struct Feature;

  void CheckTriangles() const;
  void ComputeNormals();
  int Build(int first, int count);
  Feature NearestOnTriangle(int triangle, const Eigen::Vector3d& p) const noexcept;
  double SignedDepth(const Eigen::Vector3d& p, const MeshPlace& place) const noexcept;

  TriangleMesh mesh_;
  bool forbidden_outside_;
  std::vector<Eigen::Vector3d> face_normals_, corner_normals_;
  std::vector<std::array<Eigen::Vector3d, 3>> edge_normals_;  // edge i: corners i and i + 1
  std::vector<int> order_;
  std::vector<Box> boxes_;
};

}  // namespace flextip
