#include "control/supervision/rate_limits.h"

#include <algorithm>
#include <cmath>

namespace flextip {
namespace {

/// A change of less than this part is rounding, no limit.
constexpr double kRounding = 1e-12;

}  // namespace

Limited LimitStep(const Eigen::Vector3d& p_RW, const Eigen::Vector3d& p_wish, double max_step_m) {
  const Eigen::Vector3d step = p_wish - p_RW;
  const double length = step.norm();
  if (length <= max_step_m) return {p_wish, false};
  return {p_RW + max_step_m / length * step, true};
}

Limited LimitSpeed(const Eigen::Vector3d& p_last, const Eigen::Vector3d& p_wish, double dt_s,
                   double max_speed_m_s) {
  return LimitStep(p_last, p_wish, max_speed_m_s * dt_s);
}

Limited LimitAcceleration(const Eigen::Vector3d& p_last, const Eigen::Vector3d& v_last_m_s,
                          const Eigen::Vector3d& p_wish, double dt_s,
                          double max_acceleration_m_s2) {
  const Eigen::Vector3d way = p_wish - p_last;
  const double distance = way.norm();
  // The speed from which n cycles of braking, each by `brake`, end at the place: in units of
  // brake dt the way of n - 1 + u is n (n - 1) / 2 + n u.
  const double brake = max_acceleration_m_s2 * dt_s;
  const double way_units = distance / (brake * dt_s);
  const double n = std::floor(0.5 * (1.0 + std::sqrt(1.0 + 8.0 * way_units)));
  const double stopping = brake * (n - 1.0 + (way_units - 0.5 * n * (n - 1.0)) / n);
  const double speed = std::min(distance / dt_s, stopping);
  const Eigen::Vector3d v_wish =
      distance > 0.0 ? Eigen::Vector3d(speed / distance * way) : Eigen::Vector3d::Zero();
  const Limited v = LimitStep(v_last_m_s, v_wish, brake);
  const Eigen::Vector3d p = p_last + dt_s * v.p;
  if ((p - p_wish).norm() <= kRounding * (1.0 + distance)) return {p_wish, false};
  return {p, true};
}

Limited KeepInBox(const WorkspaceBox& box, const Eigen::Vector3d& p) {
  const Eigen::Vector3d kept = p.cwiseMax(box.lower_m).cwiseMin(box.upper_m);
  return {kept, kept != p};
}

}  // namespace flextip
