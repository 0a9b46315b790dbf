#include "simulation/render/face.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace flextip::simulation::render {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A convex polygon of few corners, clipped by lines x = const or y = const.
struct SmallPolygon {
  std::array<Vector2d, 12> corner;
  int size = 0;
};

// Keeps the part with sign * (coordinate - bound) >= 0 (Sutherland and Hodgman).
SmallPolygon Clip(const SmallPolygon& in, int axis, double bound, double sign) {
  SmallPolygon out;
  for (int i = 0; i < in.size; ++i) {
    const Vector2d& a = in.corner[i];
    const Vector2d& b = in.corner[i + 1 == in.size ? 0 : i + 1];
    const double da = sign * (a[axis] - bound), db = sign * (b[axis] - bound);
    if (da >= 0) out.corner[out.size++] = a;
    if ((da < 0) != (db < 0)) out.corner[out.size++] = a + da / (da - db) * (b - a);
  }
  return out;
}

double Area(const SmallPolygon& p) {
  double twice = 0;
  for (int i = 0; i < p.size; ++i) {
    const Vector2d& a = p.corner[i];
    const Vector2d& b = p.corner[i + 1 == p.size ? 0 : i + 1];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * std::abs(twice);
}

}  // namespace

void Face::Prepare() {
  plane_distance_ = normal.dot(origin);
  origin_x_ = ex.dot(origin);
  origin_y_ = ey.dot(origin);
  edges_.clear();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const Vector2d in = Vector2d(a.y() - b.y(), b.x() - a.x()).normalized();
    edges_.emplace_back(in.x(), in.y(), -in.dot(a));
  }
}

bool Face::MeetPlane(const Vector3d& ray, double& depth, Vector2d& at) const {
  const double slope = normal.dot(ray);
  if (slope * plane_distance_ <= 0) return false;
  depth = plane_distance_ / slope;
  at = {depth * ex.dot(ray) - origin_x_, depth * ey.dot(ray) - origin_y_};
  return true;
}

bool Face::Inside(const Vector2d& at) const {
  if (disc_radius_m > 0) {
    const Vector2d from = at - disc_centre;
    const double angle = std::atan2(from.y(), from.x());
    const double rim = 1 + 0.10 * std::sin(3 * angle + 1) + 0.05 * std::sin(7 * angle);
    if (from.squaredNorm() >= std::pow(disc_radius_m * rim, 2)) return false;
  }
  for (const Vector3d& e : edges_) {
    if (e.x() * at.x() + e.y() * at.y() + e.z() < 0) return false;
  }
  return true;
}

bool Face::Intersect(const Vector3d& ray, double& depth, Vector2d& at) const {
  return MeetPlane(ray, depth, at) && Inside(at);
}

double WhitePart(const TagPattern& pattern, const Vector2d quad[4]) {
  SmallPolygon pixel;
  Vector2d low = quad[0], high = quad[0];
  for (int i = 0; i < 4; ++i) {
    pixel.corner[pixel.size++] = quad[i];
    low = low.cwiseMin(quad[i]);
    high = high.cwiseMax(quad[i]);
  }
  const double half = 0.5 * pattern.cells;
  const int c0 = pattern.Cell(low.x()), c1 = pattern.Cell(high.x());
  const int r0 = pattern.Cell(low.y()), r1 = pattern.Cell(high.y());
  if (c0 == c1 && r0 == r1) return pattern.WhiteAt(quad[0].x(), quad[0].y()) ? 1.0 : 0.0;
  const double total = Area(pixel);
  if (total <= 0) return pattern.WhiteAt(quad[0].x(), quad[0].y()) ? 1.0 : 0.0;
  double black = 0;  // only black cells are summed: what lies outside the pattern is white
  for (int c = std::max(c0, 0); c <= std::min(c1, pattern.cells - 1); ++c) {
    const SmallPolygon column = Clip(Clip(pixel, 0, c - half, 1), 0, c + 1 - half, -1);
    for (int r = std::max(r0, 0); r <= std::min(r1, pattern.cells - 1); ++r) {
      if (pattern.white[static_cast<std::size_t>(r) * pattern.cells + c]) continue;
      black += Area(Clip(Clip(column, 1, r - half, 1), 1, r + 1 - half, -1));
    }
  }
  return std::clamp(1.0 - black / total, 0.0, 1.0);
}

}  // namespace flextip::simulation::render
