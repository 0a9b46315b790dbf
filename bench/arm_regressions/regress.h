// Plain regressions of an arm's joints: what a laboratory tries first.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "arms/data/arm_data.h"

namespace flextip::bench {

/// What is left of a recording, root mean square.
struct Left {
  std::string name;
  double tip_m = 0.0;
  Eigen::VectorXd joints;  ///< rad or m
};

/// Returns what each regression leaves of the joints of `other` that an outside sensor saw, fitted
/// to those of `fitted`: nothing at all, an offset a joint, offset and scale, offset and all joints
/// (a matrix), offset and sign of the last motion, offset and play with the width that fits best.
std::vector<Left> RegressSeen(const std::vector<arms::ArmData>& fitted, const arms::ArmData& other);

/// Returns what is left of the encoders of `other`: behind its commands, and behind commands with
/// the one delay that fits best in `fitted`.
std::vector<Left> RegressFollowed(const std::vector<arms::ArmData>& fitted,
                                  const arms::ArmData& other);

}  // namespace flextip::bench
