// What was found at an arm's joints, for a controller: the numbers of model.yaml as the
// feed-forward of control/joints takes them.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "arms/diagnose/diagnose.h"
#include "control/joints/joint_feed_forward.h"

namespace flextip::arms {

struct CommandModel {
  JointModel joints;
  /// Effects of the model that no command of the joints takes away, in words, one line each.
  std::vector<std::string> not_corrected;
};

/// Takes effects that were found and those within tolerance; of the latter behind the encoders only
/// numbers whose deviation is below three tenths of their tolerance, and no play. Efforts are those
/// that the diagnosis predicted from: of the whole motion where they were measured, else what
/// gravity asks of the stated masses. Throws InputError where the model is of another arm.
CommandModel CommandModelOf(const Arm& arm, const ArmModel& model,
                            const Eigen::Vector3d& gravity_m_s2);

}  // namespace flextip::arms
