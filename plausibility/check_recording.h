// Checks whether a recording can be what it says: units, frames, clocks, noises, and whether the
// streams fit one another and the shaft through the port.
#pragma once

#include "plausibility/finding.h"
#include "recording/recording.h"

namespace flextip::plausibility {

/// Checks all but the pictures. Numbers alone, no I/O.
CheckResult CheckRecording(const Recording& recording);

/// Puts the wrong findings before the doubtful, each once.
void SortFindings(std::vector<Finding>& findings);

}  // namespace flextip::plausibility
