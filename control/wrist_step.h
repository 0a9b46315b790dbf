// What every controller does with its model and its step; carrying a late tip trusts the tissue the
// same way. Not for users.
#pragma once

#include <Eigen/Dense>

#include "estimation/shaft_model.h"

namespace flextip {

/// The tissue's stiffness as far as it may be relied on. The loop's gain along a direction is what
/// the Jacobian assumes over what is there, (1 - c k) / (1 - c k_true) with c the shaft's
/// compliance: should the tissue let go, it must stay below 2, so 1 - c k is held to `limit`.
Eigen::Matrix3d TrustedStiffness(const Eigen::Matrix3d& K, const Eigen::Matrix3d& compliance,
                                 double limit);

struct BoundedStep {
  Eigen::Vector3d step_m = Eigen::Vector3d::Zero();
  bool limited = false;
};

/// Shortens a step of the wrist to `max_step_m`, and so that the wrist keeps between 2 % and 98 %
/// of the shaft's length from the port: at either end the lever degenerates. A wrist that is beyond
/// an end comes back by `max_step_m` at most. `step` finite, `max_step_m` not negative.
BoundedStep BoundStep(const Eigen::Vector3d& step, const Eigen::Vector3d& p_RW,
                      const ShaftModel& model, double max_step_m);

}  // namespace flextip
