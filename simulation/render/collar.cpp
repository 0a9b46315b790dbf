#include "simulation/render/collar.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace flextip::simulation::render {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// The convex hull, anticlockwise, without corners on straight sides (Andrew's monotone chain).
std::vector<Vector2d> ConvexHull(std::vector<Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const Vector2d& a, const Vector2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  std::vector<Vector2d> hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t base = hull.size();
    for (const Vector2d& p : points) {
      while (hull.size() >= base + 2) {
        const Vector2d& b = hull.back();
        const Vector2d& a = hull[hull.size() - 2];
        if (Cross(b - a, p - b) > 1e-7 * (b - a).norm()) break;
        hull.pop_back();
      }
      if (hull.size() > base && (hull.back() - p).norm() < 1e-7) continue;
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

Vector2d Across(const Vector3d& v) { return v.tail<2>(); }

void Mirror(TagPattern& pattern) {
  for (int row = 0; row < pattern.cells; ++row) {
    const auto first = pattern.white.begin() + row * pattern.cells;
    std::reverse(first, first + pattern.cells);
  }
}

}  // namespace

bool CollarBody::Plate::AlongShaft() const {
  return std::abs(Normal().x()) < 1e-3 &&
         std::max(std::abs(T_EG.R(0, 0)), std::abs(T_EG.R(0, 1))) > 0.999 &&
         Across(Normal()).dot(Across(T_EG.p)) > 0;
}

CollarBody::CollarBody(const TagCollar& collar, const std::vector<int>& mirrored) {
  std::vector<Plate> left;
  for (const CollarTag& tag : collar.tags) {
    if (!(tag.size_m > 0)) {
      throw InputError(fmt::format("tag {}: found size {} m, expected > 0", tag.id, tag.size_m));
    }
    patterns_.push_back(MakeTagPattern(collar.family, tag.id));
    if (std::count(mirrored.begin(), mirrored.end(), tag.id) > 0) Mirror(patterns_.back());
    const double cell_m = tag.size_m / patterns_.back().border_cells;
    left.push_back(
        {tag.T_EG, 0.5 * patterns_.back().cells * cell_m, cell_m, tag.id, patterns_.size() - 1});
  }
  while (!left.empty()) {  // rings of tags at one place along the shaft
    const Plate first = left.front();
    const auto in_ring = [&](const Plate& p) {
      return p.AlongShaft() && first.AlongShaft() &&
             std::abs(p.T_EG.p.x() - first.T_EG.p.x()) < 0.25 * first.half_m;
    };
    std::vector<Plate> ring;
    std::copy_if(left.begin(), left.end(), std::back_inserter(ring), in_ring);
    if (ring.empty()) {
      AddLonePlate(first);
      left.erase(left.begin());
    } else {
      AddPrism(ring);
      std::erase_if(left, in_ring);
    }
  }
}

void CollarBody::AddLonePlate(const Plate& plate) {
  const auto corner = [&](double x, double y) {
    return plate.T_EG * (plate.half_m * Vector3d(x, y, 0));
  };
  std::vector<Vector3d> corners = {corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)};
  AddFace(corners, plate.Normal(), &plate);
  AddFace(corners, -plate.Normal(), nullptr);
}

void CollarBody::AddPrism(const std::vector<Plate>& ring) {
  std::vector<Vector2d> points;
  double x0 = 1e9, x1 = -1e9, core = 1e9;
  for (const Plate& plate : ring) {
    const Vector2d n = Across(plate.Normal()), c = Across(plate.T_EG.p), along(-n.y(), n.x());
    double low = -plate.half_m, high = plate.half_m;
    for (const Plate& other : ring) {  // what of this plate is behind the other's plane
      const Vector2d m = Across(other.Normal());
      const double rate = m.dot(along), gap = m.dot(Across(other.T_EG.p) - c);
      if (rate > 1e-9) high = std::min(high, gap / rate);
      if (rate < -1e-9) low = std::max(low, gap / rate);
    }
    if (low < high) {
      points.emplace_back(c + low * along);
      points.emplace_back(c + high * along);
    }
    x0 = std::min(x0, plate.T_EG.p.x() - plate.half_m);
    x1 = std::max(x1, plate.T_EG.p.x() + plate.half_m);
    core = std::min(core, 0.8 * n.dot(c));
  }
  for (int i = 0; i < 24; ++i) {
    const double angle = 2 * std::numbers::pi * i / 24;
    points.emplace_back(core * Vector2d(std::cos(angle), std::sin(angle)));
  }
  const std::vector<Vector2d> section = ConvexHull(points);
  for (std::size_t i = 0; i < section.size(); ++i) {
    AddSide(ring, section[i], section[(i + 1) % section.size()], x0, x1);
  }
  for (const double x : {x0, x1}) {
    std::vector<Vector3d> corners;
    corners.reserve(section.size());
    for (const Vector2d& p : section) corners.emplace_back(x, p.x(), p.y());
    AddFace(corners, Vector3d(x == x0 ? -1 : 1, 0, 0), nullptr);
  }
}

void CollarBody::AddSide(const std::vector<Plate>& ring, const Vector2d& a, const Vector2d& b,
                         double x0, double x1) {
  const Vector3d normal = Vector3d(0, b.y() - a.y(), a.x() - b.x()).normalized();
  const Plate* plate = nullptr;
  for (const Plate& p : ring) {
    const double off = std::abs(p.Normal().dot(p.T_EG.p - Vector3d(x0, a.x(), a.y())));
    if (p.Normal().dot(normal) > 0.99999 && off < 1e-6) plate = &p;
  }
  AddFace({{x0, a.x(), a.y()}, {x1, a.x(), a.y()}, {x1, b.x(), b.y()}, {x0, b.x(), b.y()}}, normal,
          plate);
}

void CollarBody::AddFace(const std::vector<Vector3d>& corners, const Vector3d& normal,
                         const Plate* plate) {
  Face face;
  face.normal = normal;
  if (plate) {
    face.origin = plate->T_EG.p;
    face.ex = plate->T_EG.R.col(0);
    face.ey = plate->T_EG.R.col(1);
    face.normal = plate->Normal();
    face.cell_m = plate->cell_m;
    face.tag_id = plate->id;
  } else {
    face.origin = corners[0];
    face.ex = (corners[1] - corners[0]).normalized();
    face.ey = normal.cross(face.ex);
  }
  double twice_area = 0;
  for (const Vector3d& x : corners) {
    face.polygon.emplace_back(face.ex.dot(x - face.origin), face.ey.dot(x - face.origin));
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    twice_area += Cross(face.polygon[i], face.polygon[(i + 1) % corners.size()]);
  }
  if (twice_area < 0) std::reverse(face.polygon.begin(), face.polygon.end());
  faces_.push_back(face);
  pattern_of_.push_back(plate ? plate->pattern : patterns_.size());
}

std::vector<Face> CollarBody::FacesSeen(const Pose& T_CE) const {
  std::vector<Face> seen;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    Face face = faces_[i];
    face.origin = T_CE * face.origin;
    face.ex = T_CE.R * face.ex;
    face.ey = T_CE.R * face.ey;
    face.normal = T_CE.R * face.normal;
    if (!face.FacesCamera()) continue;
    if (pattern_of_[i] < patterns_.size()) face.pattern = &patterns_[pattern_of_[i]];
    face.Prepare();
    seen.push_back(face);
  }
  return seen;
}

}  // namespace flextip::simulation::render
