// A flat piece in the camera's frame: a side of the collar with its tag, or a patch.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "simulation/render/tag_pattern.h"

namespace flextip::simulation::render {

/// A convex polygon, or a disc with a wavy rim, in the plane through `origin` spanned by the unit
/// vectors `ex`, `ey`. With a pattern, (x, y) are the tag's own axes G.
struct Face {
  Eigen::Vector3d origin, ex, ey, normal;  ///< `normal`: unit, out of the visible side
  bool two_sided = false;
  std::vector<Eigen::Vector2d> polygon;  ///< corners (m), anticlockwise in (ex, ey)
  double disc_radius_m = 0;              ///< where > 0, only what lies in the disc as well
  Eigen::Vector2d disc_centre = Eigen::Vector2d::Zero();
  const TagPattern* pattern = nullptr;
  double cell_m = 0;       ///< side of a cell of the pattern
  int tag_id = -1;         ///< of the tag on it
  double bulge_per_m = 0;  ///< how the normal that gives the shading leans outward

  bool FacesCamera() const { return two_sided || normal.dot(origin) < 0; }
  /// Prepares Intersect; to be called once the fields above are set.
  void Prepare();
  /// Meets the ray from the camera's centre; `at`: the place in (ex, ey), m.
  bool Intersect(const Eigen::Vector3d& ray, double& depth, Eigen::Vector2d& at) const;
  /// The place where the ray meets the whole plane; false where it does not meet it in front.
  bool MeetPlane(const Eigen::Vector3d& ray, double& depth, Eigen::Vector2d& at) const;
  /// The normal for shading.
  Eigen::Vector3d NormalAt(const Eigen::Vector2d& at) const {
    if (bulge_per_m == 0) return normal;
    return (normal + bulge_per_m * (at.x() * ex + at.y() * ey)).normalized();
  }
  bool White(const Eigen::Vector2d& at) const {
    return !pattern || pattern->WhiteAt(at.x() / cell_m, at.y() / cell_m);
  }

 private:
  bool Inside(const Eigen::Vector2d& at) const;
  std::vector<Eigen::Vector3d> edges_;  // (a, b, c): inside where a x + b y + c >= 0
  double plane_distance_ = 0, origin_x_ = 0, origin_y_ = 0;
};

/// The part of the pattern's area under the pixel that is white; `quad`: the pixel's four corners
/// on the plane, in order around, in cells from the tag's centre. Exact for straight edges.
double WhitePart(const TagPattern& pattern, const Eigen::Vector2d quad[4]);

}  // namespace flextip::simulation::render
