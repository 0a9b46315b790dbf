// What a recording states of instrument, gravity, camera and tags, against what can be.
#pragma once

#include <vector>

#include "plausibility/finding.h"
#include "recording/recording.h"

namespace flextip::plausibility {

/// Finds numbers that no instrument, sensor or camera has. Mends in `repaired` those with one
/// remedy, so that the others can still be judged.
std::vector<Finding> CheckLimits(const Recording& recording, Recording& repaired);

}  // namespace flextip::plausibility
