// The wrist's set-point as a pose.
#pragma once

#include "core/pose.h"

namespace flextip::live {

/// Returns the wrist at `p_RW_command` with the orientation of `T_RW`, the measured wrist, turned
/// without twist as the direction to the port `p_RP` turns on the way: the shaft keeps going
/// through the port. Within 1 mm of the port the direction says nothing, and the orientation stays.
Pose SetPoint(const Pose& T_RW, const Eigen::Vector3d& p_RW_command, const Eigen::Vector3d& p_RP);

}  // namespace flextip::live
