// The noise of streams from their differences of high order, which motion hardly reaches.
#pragma once

#include <optional>
#include <vector>

#include "plausibility/finding.h"
#include "recording/recording.h"

namespace flextip::plausibility {

struct NoiseRange {
  double least = 0.0, most = 0.0;  ///< standard deviation per component, over several steps
};

/// Returns the noise of evenly sampled numbers, one series a component. Empty with fewer than 30
/// samples, and where the samples do not resolve the motion; with fewer than 60 `most` is infinite.
std::optional<NoiseRange> NoiseOf(const std::vector<std::vector<double>>& components);

/// Finds noises beyond a factor 3 of the stated ones. What command0 commands of it is motion.
/// Streams in `but` are left out.
std::vector<Finding> CheckNoise(const Recording& recording, const std::vector<std::string>& but);

}  // namespace flextip::plausibility
