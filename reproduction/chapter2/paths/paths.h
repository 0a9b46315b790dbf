// Paths of the tip of 2.3.2: by quasi-static steps, and by an arm with inertia, PID and friction at
// the port. Private to reproduction. Positions are (z, y) in m.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "simulation/arm/dynamic_arm.h"
#include "workspace/planar_instrument.h"

namespace flextip::reproduction {

struct TrajectoryMove {
  PlanarInstrument instrument;
  Eigen::Vector2d p_port_estimated = {0.170, 0.020};  ///< the port in the controller's Jacobian
  Eigen::Vector2d p_start = Eigen::Vector2d::Zero(), p_goal = Eigen::Vector2d::Zero();
};

struct TrajectoryPath {
  std::vector<Eigen::Vector2d> p_tip;
  std::vector<double> t_s;  ///< times of a dynamic path
  bool reached = false;     ///< came within kGoalReached_m and stayed there
  bool left_port = false;   ///< ended early: the shaft no longer reached the port
};
inline constexpr double kGoalReached_m = 0.0005;

/// Steps of `gain` J_hat^-1 (x_d - x), each made to its end.
TrajectoryPath QuasiStaticPath(const TrajectoryMove& move, double gain);

/// How the joints' desired angles follow from (2.1).
enum class JointGoal : std::uint8_t {
  kFromMeasured,  ///< theta_d = theta + k J_hat^-1 (x_d - x), as in (3.4)
  kAccumulated,   ///< theta_d += k J_hat^-1 (x_d - x)
};

struct ArmRig {
  simulation::ArmBody body;
  double shaft_mass_kg = 0.011;  ///< 320 mm of chapter 4's rod
  double gravity_m_s2 = 0.0;     ///< gravity on the shaft; balanced by default
  double friction_N = 0.0;
  JointGoal joint_goal = JointGoal::kFromMeasured;
  double gain = 1.0;
  /// A time constant kd / kp of 0.3 s and an integral time kp / ki of 50 s: slow and over-damped.
  simulation::PidGains pid{5.0, 0.1, 1.5};
  double link_error = 0.0;   ///< the links are longer than the controller's by this part
  double encoder_rad = 0.0;  ///< resolution of the joints' angles
  double rate_hz = 1000.0;   ///< rate of the PID and of (2.1)
  int substeps = 20;         ///< steps of the integration in a period
  double longest_s = 10.0;
};

/// The tip as the arm's controller calculates it, from joint angles and the true port.
TrajectoryPath DynamicPath(const TrajectoryMove& move, const ArmRig& rig);

/// The largest distance of a point of `path` from the curve `reference` (m).
double LargestDistance(const TrajectoryPath& path, const TrajectoryPath& reference);
/// The largest angle between where the tip goes and where the goal lies (rad), up to the last
/// `near_m` from the goal.
double LargestHeadingError(const TrajectoryPath& path, const Eigen::Vector2d& p_goal,
                           double near_m);
/// By how much the distance to the goal grows again after it was smaller (m).
double MovesAway(const TrajectoryPath& path, const Eigen::Vector2d& p_goal);

}  // namespace flextip::reproduction
