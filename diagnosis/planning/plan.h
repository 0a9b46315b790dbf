// What is asked of a plan of the next motion, and the plan.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

namespace flextip::diagnosis {

/// A hypothesis is certain with this probability.
inline constexpr double kCertain = 0.95;

/// What the robot and the room allow; what is absent is as it was in the recording. The port's
/// force may then always be 1.2 EI / L^2, which bears a small weight at the tip.
struct MotionLimits {
  double seconds = 20.0;
  std::optional<double> wrist_speed_m_s;
  std::optional<double> port_force_N;  ///< across the shaft
  std::optional<double> inserted_from_m, inserted_to_m;
  std::optional<double> angle_rad;  ///< from the recorded mean direction of the shaft
  bool may_hang_weight = true;
};

struct NextMotion {
  bool needed = false;  ///< else the recording has told them apart already
  /// What is to be told apart, each by its effects' names.
  std::vector<std::vector<std::string>> rivals;
  std::vector<Eigen::Vector3d> places_m;     ///< of the tip, in R; empty: no motion
  double speed_m_s = 0.0;                    ///< of the tip
  double load_N = 0.0;                       ///< weight to hang from the tip
  double seconds = 0.0;                      ///< the motion's length
  std::optional<double> seconds_to_certain;  ///< empty: `seconds` are not enough
  double probability = 0.0;  ///< least, over the rivals, if that one is right, at the end
  std::vector<std::string> least_sure;  ///< that rival
  double probability_now = 0.0;         ///< the same without a motion
  /// The same of the best of the simple motions that a person can make, within no limits.
  std::string library_motion;
  std::optional<double> library_seconds_to_certain;
  double library_probability = 0.0;
};

}  // namespace flextip::diagnosis
