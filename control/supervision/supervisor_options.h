// The supervisor's limits, with units.
#pragma once

#include <cstdint>
#include <numbers>
#include <optional>
#include <string_view>

namespace flextip {

/// How much stands between controller and robot.
enum class SupervisionKind : std::uint8_t {
  kNone,             ///< the command as the controller has it
  kRateLimits,       ///< its step, speed and acceleration are limited; the goal waits for a wrist
                     ///< that stands
  kFixedThresholds,  ///< and a tip that jumps, or leaves the other sensors, by a fixed distance
                     ///< holds
  kFull              ///< all that stops.h names, by covariances
};
const char* Name(SupervisionKind kind);  ///< "none", "rate-limits", "fixed-thresholds", "full"
std::optional<SupervisionKind> SupervisionKindNamed(std::string_view name);

/// Limits of the commanded wrist. Zero: no limit.
struct RateLimits {
  double max_step_m = 0.0;  ///< from the measured wrist
  double max_speed_m_s = 0.0;
  double max_acceleration_m_s2 = 0.0;
  double max_jerk_m_s3 = 0.0;  ///< needs a limit of acceleration
};

/// One standard deviation each of what counts as within specification: the tolerances of
/// docs/effects.md, as they reach a sensor.
struct SensorTolerances {
  double stiffness = 0.02;    ///< part of the bending stiffness
  double tip_m = 0.0003;      ///< hand-eye, the collar's place on the tip, 3 ms at 30 mm/s
  double em_m = 0.00025;      ///< its place on the shaft, the field, 3 ms at 30 mm/s
  double wrist_m = 0.0001;    ///< backlash, and what the arm yields
  double turn_rad = 0.0015;   ///< of every direction: a curvature of 0.003 1/m over half a metre
  double moment_Nm = 0.0015;  ///< of a gage: the same curvature, and a minute of warming up
};

struct SupervisorOptions {
  SupervisionKind kind = SupervisionKind::kNone;
  RateLimits rates;
  double rate_hz = 30.0;  ///< of the cycles
  /// Of one test in one cycle: one in ten hours of 30 Hz over the ten tests of a cycle.
  double false_alarm = 1e-7;
  /// Of one sensor against the others: as likely as this by chance, and the wrist waits.
  double doubt = 1e-3;
  double doubt_s = 0.6;  ///< so long; of sensors or wrist it then holds; 0: never
  SensorTolerances tolerances;
  double resume_after_s = 0.2;  ///< a hold ends when its cause has been gone for so long
  double fault_after_s = 2.0;   ///< a hold that lasts so long becomes a fault
  double stale_s = 0.12;        ///< a stream without a new sample for so long is gone
  int max_late_cycles = 3;      ///< in a row, each half a cycle late at least
  double follow_lag_s = 0.25;   ///< the robot is where it was commanded to be so long ago at least
  double max_motion_angle_rad = 0.25 * std::numbers::pi;  ///< never 90 degrees or more
  double max_tip_force_N = 0.0;                           ///< 0: no limit
  double max_tip_deviation_m = 0.0;                       ///< of the tip from its way; 0: no limit
  double fixed_jump_m = 0.005;                            ///< of kFixedThresholds
};

}  // namespace flextip
