// The robot of the thesis's 2.3.1: a planar two-link arm that holds a straight shaft through a port.
// Positions are (z, y) in the arm's frame A (kinematics/arm.h).
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "kinematics/arm.h"

namespace flextip {

struct PlanarInstrument {
  PlanarArm arm;
  double shaft_m = 0.32;
  Eigen::Vector2d p_port = {0.16, 0.0};

  /// (3.27) in the plane: on the line from the wrist through the port, one shaft length on. Empty
  /// where the wrist is at the port or the shaft does not reach it.
  std::optional<Eigen::Vector2d> Tip(const Eigen::Vector2d& p_wrist) const;
  /// d tip / d wrist; not for a wrist at the port.
  Eigen::Matrix2d TipByWrist(const Eigen::Vector2d& p_wrist) const;
  /// The wrist that puts the tip there, the shaft through the port. Empty where there is none, or
  /// where the arm cannot put the wrist there within its limits.
  std::optional<Eigen::Vector2d> WristForTip(const Eigen::Vector2d& p_tip) const;
};

}  // namespace flextip
