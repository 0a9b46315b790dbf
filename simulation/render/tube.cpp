#include "simulation/render/tube.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace flextip::simulation::render {
namespace {

using Eigen::Vector3d;

constexpr int kTableSteps = 2048;
constexpr double kPlaceTolerance_m = 5e-5;  // leaves kappa * tolerance^2 / 2, some nanometres
constexpr int kMaxIterations = 8;

// Tangents (unit speed) at the points by the parabola through three neighbours; the spacing may
// be uneven.
std::vector<Vector3d> Slopes(const std::vector<Vector3d>& p, const std::vector<double>& s) {
  const std::size_t n = p.size();
  std::vector<Vector3d> slopes(n);
  for (std::size_t i = 0; i < n; ++i) {
    if (n == 2) {
      slopes[i] = (p[1] - p[0]) / (s[1] - s[0]);
      continue;
    }
    const std::size_t m = std::clamp<std::size_t>(i, 1, n - 2);
    const double h0 = s[m] - s[m - 1], h1 = s[m + 1] - s[m];
    const Vector3d v0 = (p[m] - p[m - 1]) / h0, v1 = (p[m + 1] - p[m]) / h1;
    const Vector3d curvature = (v1 - v0) / (h0 + h1);  // half the second derivative
    slopes[i] = v0 + curvature * (2.0 * s[i] - s[m - 1] - s[m]);
  }
  return slopes;
}

// The cubic Hermite curve and its derivative.
void Hermite(const Vector3d& p0, const Vector3d& p1, const Vector3d& m0, const Vector3d& m1,
             double h, double u, Vector3d& point, Vector3d& derivative) {
  const double u2 = u * u, u3 = u2 * u;
  point = (2 * u3 - 3 * u2 + 1) * p0 + (3 * u2 - 2 * u3) * p1 + h * (u3 - 2 * u2 + u) * m0 +
          h * (u3 - u2) * m1;
  derivative = (6 * u2 - 6 * u) / h * (p0 - p1) + (3 * u2 - 4 * u + 1) * m0 + (3 * u2 - 2 * u) * m1;
}

}  // namespace

Tube::Tube(const std::vector<Vector3d>& points, const Vector3d& last_tangent, double radius_m,
           Ends ends)
    : radius_m_(radius_m), ends_(ends) {
  FLEXTIP_CHECK(points.size() >= 2 && radius_m > 0, "a tube has two points and a radius");
  std::vector<double> s(points.size(), 0.0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    s[i] = s[i - 1] + (points[i] - points[i - 1]).norm();
  }
  std::vector<Vector3d> slopes = Slopes(points, s);
  if (last_tangent.squaredNorm() > 0) slopes.back() = last_tangent.normalized();
  step_m_ = s.back() / kTableSteps;
  points_.resize(kTableSteps + 1);
  tangents_.resize(kTableSteps + 1);
  std::size_t i = 0;
  for (std::size_t k = 0; k <= kTableSteps; ++k) {
    const double at = step_m_ * static_cast<double>(k);
    while (i + 2 < points.size() && at > s[i + 1]) ++i;
    const double h = s[i + 1] - s[i];
    Hermite(points[i], points[i + 1], slopes[i], slopes[i + 1], h, (at - s[i]) / h, points_[k],
            tangents_[k]);
    tangents_[k].normalize();
  }
}

void Tube::Curve(double s_m, Vector3d& point, Vector3d& tangent) const {
  const double position = s_m / step_m_;
  const double inside = std::clamp(position, 0.0, static_cast<double>(kTableSteps));
  const auto k = std::min(static_cast<std::size_t>(inside), points_.size() - 2);
  const double u = inside - static_cast<double>(k);
  tangent = tangents_[k] + u * (tangents_[k + 1] - tangents_[k]);
  point = points_[k] + u * (points_[k + 1] - points_[k]) + (position - inside) * step_m_ * tangent;
}

bool Tube::Intersect(const Vector3d& ray, double& s_m, Hit& hit) const {
  // A cylinder along the tangent at s stands for the tube near s; the point met gives the next s.
  const double first_m = ends_.first_round ? radius_m_ : 0.0;
  const double last_m = LengthM() - (ends_.last_round ? radius_m_ : 0.0);
  Vector3d c, t;
  bool met = false, inside = false;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    s_m = std::clamp(s_m, first_m - 4 * radius_m_, last_m + 4 * radius_m_);
    Curve(s_m, c, t);
    const double along = ray.dot(t), height = c.dot(t);
    const double a = ray.squaredNorm() - along * along;
    const double b = ray.dot(c) - along * height;
    const double gap = c.squaredNorm() - height * height - radius_m_ * radius_m_;
    const double discriminant = b * b - a * gap;
    met = discriminant >= 0;
    inside = gap < 0;  // the camera looks along the tube: only an end can be seen
    if (inside || a <= 0) break;
    hit.depth = (b - (met ? std::sqrt(discriminant) : 0.0)) / a;
    const double change = hit.depth * along - height;
    s_m += change;
    if (std::abs(change) < kPlaceTolerance_m) break;
  }
  if (inside) {
    s_m = t.dot(c) > 0 ? first_m : last_m;
    return IntersectEnd(ray, s_m, hit);
  }
  if (!met || hit.depth <= 0) return false;
  if (s_m > last_m) return ends_.last_round && IntersectEnd(ray, last_m, hit);
  if (s_m < first_m) return ends_.first_round && IntersectEnd(ray, first_m, hit);
  Curve(s_m, c, t);
  const Vector3d out = hit.depth * ray - c;
  hit.normal = (out - out.dot(t) * t).normalized();
  return true;
}

bool Tube::IntersectEnd(const Vector3d& ray, double s_end_m, Hit& hit) const {
  Vector3d c, t;
  Curve(s_end_m, c, t);
  const double a = ray.squaredNorm(), b = ray.dot(c);
  const double discriminant = b * b - a * (c.squaredNorm() - radius_m_ * radius_m_);
  if (discriminant < 0) return false;
  hit.depth = (b - std::sqrt(discriminant)) / a;
  if (hit.depth <= 0) return false;
  hit.normal = (hit.depth * ray - c) / radius_m_;
  return true;
}

}  // namespace flextip::simulation::render
