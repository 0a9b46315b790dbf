#include "workspace/outline.h"

#include <algorithm>
#include <cmath>

#include "core/check.h"

namespace flextip {
namespace {

using Eigen::Vector2d;
using Polygon = std::vector<Vector2d>;

/// The part of a convex polygon with `normal . p <= most`.
Polygon Clip(const Polygon& polygon, const Vector2d& normal, double most) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double out_a = normal.dot(a) - most, out_b = normal.dot(b) - most;
    if (out_a <= 0.0) kept.push_back(a);
    if (out_a * out_b < 0.0) kept.push_back(a + out_a / (out_a - out_b) * (b - a));
  }
  return kept;
}

/// The joint angles that the limits allow, counter-clockwise.
Polygon JointPolygon(const LinkLimits& limits) {
  Polygon box{{limits.joint1_min, limits.joint2_min},
              {limits.joint1_max, limits.joint2_min},
              {limits.joint1_max, limits.joint2_max},
              {limits.joint1_min, limits.joint2_max}};
  box = Clip(box, {1.0, 1.0}, limits.sum_max);
  return Clip(box, {-1.0, -1.0}, -limits.sum_min);
}

/// How far a wrist is beyond the shaft's reach.
double Beyond(const PlanarInstrument& instrument, const Vector2d& p_wrist) {
  return (instrument.p_port - p_wrist).norm() - instrument.shaft_m;
}

}  // namespace

std::vector<Vector2d> WristOutline(const PlanarArm& arm, double spacing_m) {
  FLEXTIP_CHECK(spacing_m > 0.0, "a positive spacing");
  const Polygon joints = JointPolygon(arm.limits);
  const double reach = arm.link1_m + arm.link2_m;  // no joint moves the wrist by more per radian
  std::vector<Vector2d> outline;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Vector2d &a = joints[i], &b = joints[(i + 1) % joints.size()];
    const int count = std::max(1, int(std::ceil((b - a).norm() * reach / spacing_m)));
    for (int k = 0; k < count; ++k) outline.push_back(arm.Wrist(a + double(k) / count * (b - a)));
  }
  if (!outline.empty()) outline.push_back(outline.front());
  return outline;
}

std::vector<Vector2d> TipOutline(const PlanarInstrument& instrument, double spacing_m) {
  // Wrists at the end of the shaft's reach have the tip in the port, whatever their direction.
  const auto wrists = WristOutline(instrument.arm, 0.2 * spacing_m);
  std::vector<Vector2d> tips;
  for (const Vector2d& p_wrist : wrists) {
    const auto tip = instrument.Tip(p_wrist);
    const Vector2d next =
        tip && Beyond(instrument, p_wrist) < 0.0 ? *tip : Vector2d(instrument.p_port);
    if (tips.empty() || (tips.back() - next).norm() >= 0.5 * spacing_m) tips.push_back(next);
  }
  if (!tips.empty()) tips.push_back(tips.front());
  return tips;
}

WristPositions FindWristPositions(const PlanarInstrument& instrument, double spacing_m) {
  WristPositions found{.spacing_m = spacing_m};
  const PlanarArm& arm = instrument.arm;
  const Vector2d shoulder(-arm.link1_m, arm.link2_m);
  const int count = int(std::ceil((arm.link1_m + arm.link2_m) / spacing_m));
  for (int r = -count; r <= count; ++r) {
    for (int c = -count; c <= count; ++c) {
      const Vector2d p =
          (shoulder / spacing_m).array().round().matrix() * spacing_m + spacing_m * Vector2d(c, r);
      if (arm.Solve(p).status != ArmStatus::kOk) continue;
      (Beyond(instrument, p) < 0.0 ? found.reaching : found.not_reaching).push_back(p);
    }
  }
  return found;
}

}  // namespace flextip
