// How long a path takes.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "control/tip_path.h"

namespace flextip {

inline constexpr double kLongestPath_s = 4500.0;

/// Returns the longest time (s) that the path takes at `update_rate_hz`; of places in R from
/// `p_start` (m, in R), where it is known, else from the first of them.
double PathSeconds(const PathSetup& path, double update_rate_hz,
                   const std::optional<Eigen::Vector3d>& p_start = {});

}  // namespace flextip
