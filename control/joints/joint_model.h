// What an arm does with its joints' commands, as numbers: from a command to what the encoders
// measure, from there to the true joint. Fixed size: nothing is allocated.
//   measured = lag(command(t - delay) - droop * effort) - inertia * acceleration
//   true = offset + (scale + coupling) measured - compliance * effort + play * state
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>

#include "control/joints/arm_effort.h"

namespace flextip {

/// Numbers a joint in its own unit: rad and Nm, or m and N.
struct JointModel {
  /// An arm that does as it is told.
  explicit JointModel(int joints);

  int size = 0;
  double delay_s = 0.0;           ///< commands arrive so late
  JointVector lag_s, inertia_s2;  ///< of the servo: what it follows late, what inertia stretches
  JointVector droop;              ///< off the command by the effort, rad/Nm
  JointVector offset, scale;      ///< true = scale * measured + offset
  JointMatrix coupling;           ///< zero on its diagonal
  JointVector compliance;         ///< behind the encoder, rad/Nm
  /// (i, j): how far joint i goes while joint j crosses its play. States lie in -1/2 .. 1/2, at
  /// -1/2 after a motion up.
  JointMatrix play;
  std::optional<ArmEffort> effort;       ///< what a motion asks for; absent: only what is measured
  bool effort_at_rest = false;           ///< expected as if the arm stood, whatever its rates
  std::array<bool, kMaxJoints> turns{};  ///< else it slides
};

}  // namespace flextip
