// Finds what makes the streams of a recording misfit.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "plausibility/finding.h"
#include "plausibility/scene.h"
#include "recording/recording.h"

namespace flextip::plausibility {

/// Undoes every known fault in turn where a relation is violated, and returns the one after which
/// all streams fit best, up to three faults one after the other. Where none helps, the finding is
/// "unexplained" and names the stream without which the others fit. `shifts` are the clock
/// corrections found so far, `supposed` those that are to be tried, `unknown` the subjects that are
/// not judged.
std::vector<Finding> SearchFaults(const Recording& recording, const Shifts& shifts,
                                  const Shifts& supposed, const std::set<std::string>& unknown);

}  // namespace flextip::plausibility
