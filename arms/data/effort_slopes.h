// How the efforts of stated masses change where joints, or links, are not where they are said to
// be.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "arms/data/arm_data.h"

namespace flextip::arms {

/// Rows of `ArmData::torque` x measured joints, for each joint (per rad or m), and for each number
/// of the links' geometry (Kinematics). Empty where no masses are stated, or nothing but the
/// efforts would show such a change.
struct EffortSlopes {
  std::vector<Eigen::MatrixXd> by_joint, by_geometry;
};
EffortSlopes SlopesOf(const ArmData& data);

/// Efforts of the stated masses, rows of `ArmData::torque` x measured joints.
Eigen::MatrixXd StatedEffort(const ArmData& data);

}  // namespace flextip::arms
