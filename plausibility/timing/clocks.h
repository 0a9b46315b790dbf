// Clocks that differ from the wrist's.
#pragma once

#include <set>
#include <vector>

#include "plausibility/scene.h"
#include "plausibility/timing/rows.h"

namespace flextip::plausibility {

/// Finds streams that do not meet wrist0's times, streams whose times start at 0 while those of the
/// wrist do not, and em0, vision0 and command0 where their speed lags behind the speed that the
/// wrist makes. Adds the corrections of the wrong ones to `shifts`. Subjects in `unknown` are not
/// compared by motion ("port", "length"). `supposed` gets the corrections of those that start at 0
/// where nothing else tells yet.
std::vector<Finding> CheckClocks(const Recording& recording, const std::vector<Rows>& rows,
                                 const std::set<std::string>& unknown, Shifts& shifts,
                                 Shifts& supposed);

/// Finds strain0 and load0 where they lag behind the bending that they make, where the streams that
/// see the bending fit one another. A stream in `shifts` or `supposed` is compared again, near its
/// shift, and gets a finding of the same id.
std::vector<Finding> CheckForceClocks(const Recording& recording,
                                      const std::set<std::string>& unknown, const Shifts& supposed,
                                      Shifts& shifts);

/// Returns the finding that a stream's stamps are `ahead_s` (negative: behind).
Finding ClockFinding(const std::string& stream, double ahead_s, const std::string& evidence);

}  // namespace flextip::plausibility
