// The arm as a person sees it: its joints in one plane.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "arms/data/arm_data.h"

namespace flextip::arms {

/// Returns base and joints (m) in the plane that shows most of the arm, as it stands in the middle
/// of the recording. Joints at one place follow each other at a twentieth of the arm's size, so
/// that each can be seen.
std::vector<Eigen::Vector2d> SideView(const ArmData& data);

}  // namespace flextip::arms
