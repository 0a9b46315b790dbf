#include "task/path_time.h"

namespace flextip {

double PathSeconds(const PathSetup& path, double update_rate_hz,
                   const std::optional<Eigen::Vector3d>& p_start) {
  if (path.mode == PathMode::kSteps) {
    const auto legs = static_cast<double>(path.waypoints_m.size());
    return (legs * (path.max_updates + 1) + 1) / update_rate_hz;
  }
  double length_m = 0.0;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();  // the start
  if (path.frame == PathFrame::kRobot) last = p_start.value_or(path.waypoints_m.front());
  for (const Eigen::Vector3d& waypoint : path.waypoints_m) {
    length_m += (waypoint - last).norm();
    last = waypoint;
  }
  return length_m / path.speed_m_s + path.settle_s + 2.0 / update_rate_hz;
}

}  // namespace flextip
