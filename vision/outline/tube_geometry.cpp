#include "vision/outline/tube_geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/rotation.h"
#include "vision/tags/cells.h"

namespace flextip {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kClear_px = 4.0;   // from the end's corner and from the collar
constexpr double kLeastSine = 0.2;  // of the angle between tube and line of sight
constexpr int kWalkSteps = 24;
// Reach of a collar beyond its tags' white margins: as a part of a tag's size, and at least (m).
constexpr double kBodyMargin = 0.05, kBodyMargin_m = 0.0003;

struct View {
  const CameraModel& camera;
  const TubeShape& tube;
  const Pose& T_CE;
  const Vector2d& bend;
  double focal_px;
  double RadiusM() const { return 0.5 * tube.diameter_m; }
};

bool InPicture(const CameraCalibration& c, const Vector2d& px) {
  return px.x() >= 0 && px.y() >= 0 && px.x() <= c.width_px - 1 && px.y() <= c.height_px - 1;
}

// The point X of the surface (in C) at the distance s_m behind E, where the outline's tangent is
// the picture of `line`. Moving X within the plane of `line` and the ray leaves the outline: so
// only the rigid motion of X counts for the derivative, not how the point of touch moves on the
// tube.
std::optional<ContourPoint> OnOutline(const View& v, const Vector3d& X, const Vector3d& line,
                                      const Vector3d& out, double s_m) {
  Eigen::Matrix<double, 2, 3> J;
  const auto px = v.camera.Project(X, &J);
  if (!px || !InPicture(v.camera.Calibration(), *px)) return {};
  const Vector2d along = (J * line).normalized();
  ContourPoint point;
  point.px = *px;
  point.outward = {along.y(), -along.x()};
  if (point.outward.dot(J * out) < 0) point.outward = -point.outward;
  const Eigen::RowVector3d gradient = point.outward.transpose() * J;
  point.J_pose << -gradient * Skew(X - v.T_CE.p), gradient;
  const double lever = s_m * s_m * s_m / 6;
  point.J_bend = gradient * v.T_CE.R.rightCols<2>() * lever;
  point.radius_px = v.focal_px * v.RadiusM() / X.z();
  return point;
}

// Returns whether the ray to X, which touches the tube, may pass through or before the collar.
bool NearCollar(const View& v, const Vector3d& X) {
  if (!v.tube.collar) return false;
  const TubeShape::Collar& collar = *v.tube.collar;
  const double x = (v.T_CE.R.transpose() * (X - v.T_CE.p)).x();
  const double along = v.T_CE.R.col(0).dot(X.normalized()), r = v.RadiusM();
  // The ray leaves the tube's radius r for the collar's after this way; it moves along x meanwhile.
  const double way = std::sqrt(std::max(0.0, collar.radius_m * collar.radius_m - r * r) /
                               std::max(1e-3, 1 - along * along));
  const double margin = way * std::abs(along) + kClear_px * X.z() / v.focal_px;
  return x + margin > collar.from_m && x - margin < collar.to_m;
}

// Returns distances behind E whose points are evenly spaced in the picture, from `first_m` to where
// the centre line leaves the picture or the length ends.
std::vector<double> EvenStations(const View& v, double first_m, int count) {
  std::vector<double> s, way_px;
  Vector2d last = Vector2d::Zero();
  for (int i = 0; i <= kWalkSteps; ++i) {
    const double at = first_m + (v.tube.length_m - first_m) * i / kWalkSteps;
    const auto px = v.camera.Project(v.T_CE * TubeCentre(v.bend, at).x_E);
    const bool inside = px && InPicture(v.camera.Calibration(), *px);
    if (!inside && !s.empty()) break;
    if (!inside) continue;
    way_px.push_back(s.empty() ? 0.0 : way_px.back() + (*px - last).norm());
    s.push_back(at);
    last = *px;
  }
  std::vector<double> stations;
  if (s.size() < 2 || way_px.back() < 2 * kClear_px) return stations;
  std::size_t k = 0;
  for (int i = 0; i < count; ++i) {
    const double want = kClear_px + (way_px.back() - kClear_px) * (i + 0.5) / count;
    while (k + 2 < s.size() && way_px[k + 1] < want) ++k;
    const double part = (want - way_px[k]) / std::max(1e-9, way_px[k + 1] - way_px[k]);
    stations.push_back(s[k] + part * (s[k + 1] - s[k]));
  }
  return stations;
}

void AddSides(const View& v, int per_side, std::vector<ContourPoint>& points) {
  const double r = v.RadiusM();
  const std::vector<double> stations = EvenStations(v, v.tube.round_end ? r : 0.0, per_side);
  for (std::size_t i = 0; i < stations.size(); ++i) {
    const CentreLinePoint at = TubeCentre(v.bend, stations[i]);
    const Vector3d c = v.T_CE * at.x_E, t = v.T_CE.R * at.t_E;
    const Vector3d across = c - c.dot(t) * t;
    const double distance = across.norm();
    if (distance < kLeastSine * c.norm() || distance <= r) continue;
    const Vector3d e = across / distance, f = t.cross(e);
    for (const double side : {-1.0, 1.0}) {  // n . (c + r n) = 0
      const Vector3d n =
          -r / distance * e + side * std::sqrt(1 - r * r / (distance * distance)) * f;
      const Vector3d X = c + r * n;
      if (NearCollar(v, X)) continue;
      auto point = OnOutline(v, X, t, n, stations[i]);
      if (!point) continue;
      point->part = side < 0 ? ContourPart::kLeft : ContourPart::kRight;
      point->place = 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(stations.size()) - 1;
      points.push_back(*point);
    }
  }
}

// Adds the end's sphere: rays touch it on the half before its centre.
void AddRoundEnd(const View& v, int at_end, std::vector<ContourPoint>& points) {
  const double r = v.RadiusM();
  const Vector3d t = v.T_CE.R.col(0), c = v.T_CE.p - r * t, e = c.normalized();
  const double sine = r / c.norm();
  if (c.z() <= r || sine >= 1) return;
  const Vector3d ahead = (t - t.dot(e) * e).normalized(), aside = e.cross(ahead);
  for (int i = 0; i < at_end; ++i) {
    const double place = 2 * (i + 0.5) / at_end - 1, angle = 0.5 * std::numbers::pi * place;
    const Vector3d n = -sine * e + std::sqrt(1 - sine * sine) *
                                       (std::cos(angle) * ahead + std::sin(angle) * aside);
    if (n.dot(t) <= 0) continue;
    const Vector3d X = c + r * n;
    if (NearCollar(v, X)) continue;
    auto point = OnOutline(v, X, n.cross(X), n, r);
    if (!point) continue;
    point->J_bend.setZero();
    point->place = place;
    points.push_back(*point);
  }
}

// Adds the end's rim. It is outline where just one of the disc and the tube's side faces the
// camera.
void AddFlatEnd(const View& v, int at_end, std::vector<ContourPoint>& points) {
  const double r = v.RadiusM();
  const Pose& E = v.T_CE;
  const Vector3d t = E.R.col(0);
  const bool disc_seen = t.dot(E.p) < 0;
  const Vector3d away = E.p - E.p.dot(t) * t;  // a flat rim's far or near half about this
  if (away.norm() <= r) return;
  const Vector3d middle = (disc_seen ? 1.0 : -1.0) * away.normalized(), aside = t.cross(middle);
  // On the side n . (p + r n) = 0 the rim meets the tube's sides: n . middle = limit.
  const double limit = (disc_seen ? -1.0 : 1.0) * r / away.norm();
  const double reach = std::acos(std::clamp(limit, -1.0, 1.0));
  const double clear = kClear_px * E.p.z() / (v.focal_px * r);  // of the picture's half width
  for (int i = 0; i < at_end; ++i) {
    const double place = 2 * (i + 0.5) / at_end - 1, angle = reach * place;
    if (std::abs(std::sin(angle)) > std::sin(std::min(reach, 0.5 * std::numbers::pi)) - clear)
      continue;
    const Vector3d n = std::cos(angle) * middle + std::sin(angle) * aside;
    const Vector3d line = -std::sin(angle) * middle + std::cos(angle) * aside;
    const Vector3d X = E.p + r * n;
    if (NearCollar(v, X)) continue;
    auto point = OnOutline(v, X, line, t + n, 0.0);
    if (!point) continue;
    point->rim = TubeRim::kFlat;
    point->place = place;
    points.push_back(*point);
  }
}

}  // namespace

TubeShape TubeOf(const TagCollar& collar, double diameter_m, bool round_end) {
  TubeShape tube;
  tube.diameter_m = diameter_m;
  tube.round_end = round_end;
  TubeShape::Collar body{HUGE_VAL, -HUGE_VAL, 0.0};
  for (const CollarTag& tag : collar.tags) {
    const TagCells cells = ReadTagCells(collar.family, tag.id);
    const double margin_m = kBodyMargin_m + kBodyMargin * tag.size_m;
    const double half_m = 0.5 * tag.size_m * cells.cells / cells.border_cells + margin_m;
    for (const double u : {-half_m, half_m}) {
      for (const double v : {-half_m, half_m}) {
        const Vector3d corner = tag.T_EG * Vector3d(u, v, 0);
        body.from_m = std::min(body.from_m, corner.x());
        body.to_m = std::max(body.to_m, corner.x());
        body.radius_m = std::max(body.radius_m, corner.tail<2>().norm());
      }
    }
  }
  if (!collar.tags.empty()) tube.collar = body;
  return tube;
}

CentreLinePoint TubeCentre(const Eigen::Vector2d& bend, double s_m) {
  const double s2 = s_m * s_m;
  const Vector2d angle = 0.5 * s2 * bend;
  const double square = angle.squaredNorm();
  CentreLinePoint at;
  at.x_E << -s_m * (1 - square / 10), s_m / 3 * (1 - square / 14) * angle;
  at.t_E = Vector3d(1 - square / 2, -angle.x() * (1 - square / 6), -angle.y() * (1 - square / 6))
               .normalized();
  return at;
}

std::vector<ContourPoint> TubeContour(const CameraModel& camera, const TubeShape& tube,
                                      const Pose& T_CE, const Eigen::Vector2d& bend, int per_side,
                                      int at_end) {
  const CameraCalibration& c = camera.Calibration();
  const View view{camera, tube, T_CE, bend, 0.5 * (c.fu_px + c.fv_px)};
  std::vector<ContourPoint> points;
  points.reserve(2 * per_side + at_end);
  AddSides(view, per_side, points);
  if (T_CE.p.z() <= tube.diameter_m) return points;
  tube.round_end ? AddRoundEnd(view, at_end, points) : AddFlatEnd(view, at_end, points);
  return points;
}

}  // namespace flextip
