#include "plausibility/relations/shaft_curve.h"

#include <algorithm>

namespace flextip::plausibility {
namespace {

using Eigen::Vector3d;

constexpr int kCurvePoints = 24;

/// Where the shaft leaves the wrist: as measured, else toward the port.
std::optional<Vector3d> BeginDirection(const Scene& scene, const Instant& now) {
  if (now.wrist->q) return ShaftAxis(*now.wrist->q);
  return DirectionToPort(scene, now);
}

}  // namespace

Vector3d ShaftCurve::Nearest(const Vector3d& p, Vector3d* along) const {
  Vector3d best = points.front();
  double least = (best - p).squaredNorm();
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vector3d step = points[i + 1] - points[i];
    const double square = step.squaredNorm();
    if (!(square > 0.0)) continue;
    const double u = std::clamp((p - points[i]).dot(step) / square, 0.0, 1.0);
    const Vector3d at = points[i] + u * step;
    if ((at - p).squaredNorm() > least && i > 0) continue;
    least = (at - p).squaredNorm();
    best = at;
    if (along != nullptr) *along = step.normalized();
  }
  return best;
}

ShaftCurve CurveBetween(const Vector3d& p_begin, const Vector3d& d_begin, const Vector3d& p_end,
                        const Vector3d& d_end, double length_m) {
  ShaftCurve curve;
  const Vector3d a = length_m * d_begin, b = length_m * d_end;
  for (int i = 0; i <= kCurvePoints; ++i) {
    const double u = static_cast<double>(i) / kCurvePoints, v = 1.0 - u;
    const Vector3d point = (1.0 + 2.0 * u) * v * v * p_begin + u * v * v * a +
                           u * u * (3.0 - 2.0 * u) * p_end - u * u * v * b;
    if (i > 0) curve.length_m += (point - curve.points.back()).norm();
    curve.points.push_back(point);
  }
  return curve;
}

std::optional<ShaftCurve> CurveToEm(const Scene& scene, const Instant& now) {
  const auto begin = BeginDirection(scene, now);
  if (!begin || !now.em0 || !now.em0->q) return {};
  return CurveBetween(now.wrist->p, *begin, now.em0->p, ShaftAxis(*now.em0->q), scene.EmAt());
}

std::optional<ShaftCurve> CurveToTip(const Scene& scene, const Instant& now) {
  const auto begin = BeginDirection(scene, now);
  if (!begin || !now.tip || !now.tip->d) return {};
  return CurveBetween(now.wrist->p, *begin, now.tip->p, *now.tip->d, scene.instrument.length_m);
}

std::optional<Vector3d> DirectionToPort(const Scene& scene, const Instant& now) {
  const Vector3d to_port = scene.p_RP - now.wrist->p;
  const double norm = to_port.norm();
  if (!(norm > 1e-6)) return {};
  return Vector3d(to_port / norm);
}

Vector3d ShaftAxis(const Eigen::Quaterniond& q) { return q * Vector3d::UnitX(); }

}  // namespace flextip::plausibility
