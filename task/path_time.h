// How long a path takes.
#pragma once

#include "control/tip_path.h"

namespace flextip {

inline constexpr double kLongestPath_s = 4500.0;

/// Returns the longest time (s) that the path takes at `update_rate_hz`.
double PathSeconds(const PathSetup& path, double update_rate_hz);

}  // namespace flextip
