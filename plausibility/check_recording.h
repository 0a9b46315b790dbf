// Checks whether a recording can be what it says: units, frames, clocks, noises, and whether the
// streams fit one another and the shaft through the port.
#pragma once

#include <set>
#include <string>

#include "plausibility/finding.h"
#include "recording/recording.h"

namespace flextip::plausibility {

struct CheckOptions {
  /// Subjects that nothing is known of yet, so that they are not judged: "port", "length",
  /// "stiffness", "strain0" (in any unit), "em0.frame", "em0.distance", "vision0.frame",
  /// "cam0.T_RC".
  std::set<std::string> unknown = {};
};

/// Checks all but the pictures. Numbers alone, no I/O.
CheckResult CheckRecording(const Recording& recording, const CheckOptions& options = {});

}  // namespace flextip::plausibility
