// Gravity's direction against a mass that hangs on the tip.
#pragma once

#include <vector>

#include "plausibility/finding.h"
#include "recording/recording.h"

namespace flextip::plausibility {

/// Finds a gravity that points against a constant load. `found` are the findings so far: a load
/// that is wrong itself tells nothing.
std::vector<Finding> CheckHungMass(const Recording& recording, const std::vector<Finding>& found);

}  // namespace flextip::plausibility
