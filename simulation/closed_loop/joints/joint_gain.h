// What a model of an arm is worth where it is to be used: as a feed-forward of its joints.
#pragma once

#include <string>
#include <vector>

#include "arms/data/arm_data.h"
#include "arms/diagnose/diagnose.h"
#include "simulation/closed_loop/joints/joint_loop.h"

namespace flextip::simulation {

struct JointGain {
  bool ran = false;                ///< false: `notes` say why
  JointLoopResult base, extended;  ///< commands as desired, and by the feed-forward
  /// One line each: what the simulated arm does not have, what no command takes away.
  std::vector<std::string> notes;
};

/// Moves a simulated arm that has what `model` says by forces in time, about the middle of the
/// joints of `data` and as far, along a motion of its own: commanded as desired, and by the
/// feed-forward. The same input gives the same figures.
JointGain MeasureJointGain(const arms::ArmData& data, const arms::ArmModel& model);

}  // namespace flextip::simulation
