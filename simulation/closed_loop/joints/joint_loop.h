// A simulated arm that is to follow a motion of its joints, with a feed-forward or without.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "control/joints/joint_feed_forward.h"
#include "simulation/joints/arm_plant.h"

namespace flextip::simulation {

/// Where the joints should be at a time, with their rates.
using JointMotion = std::function<JointWish(double t_s)>;

/// Sums of sines about `centre`, from rest: `size` is the largest of each joint, one number each.
struct SineMotion {
  Eigen::VectorXd centre, size;
  double fastest_hz = 0.4;
  std::uint64_t seed = 1;
};
JointMotion MotionOf(const SineMotion& sines);

struct JointLoopSetup {
  ArmPlantSettings plant;
  Eigen::VectorXd encoder_offset, encoder_scale;  ///< ArmFaults; empty: none
  JointMotion motion;
  double seconds = 10.0, judged_from_s = 1.5;
  double rate_hz = 500.0;           ///< of commands; each is held until the next
  std::optional<JointModel> model;  ///< of the feed-forward; absent: commands are the motion itself
  FeedForwardOptions options;
  bool measured_effort = false;  ///< the feed-forward is told the motors' efforts
  Pose T_LK;                     ///< the tip on the last link
};

/// True joints less desired ones, a joint each (rad, m), and the tip at both by the true arm.
struct JointLoopResult {
  Eigen::VectorXd rms, max;
  double tip_rms_m = 0.0, tip_max_m = 0.0;
  int cycles = 0, rate_limited = 0, correction_limited = 0;
};

/// Throws WorkError where the plant does not stay finite.
JointLoopResult RunJointLoop(const JointLoopSetup& setup);

}  // namespace flextip::simulation
