// The next motion: one that tells the leading hypotheses apart in the shortest time.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/planning/plan.h"
#include "diagnosis/replay/replay.h"
#include "diagnosis/search/selection.h"

namespace flextip::diagnosis {

/// Throws InputError, beginning with `name`, for limits that leave no motion.
void RequireUsable(const MotionLimits& limits, const SampleSet& recorded, const std::string& name);

/// Plans for what `selection` leaves in the lead (rivals.h) and for `groups` of effects that look
/// alike, at the point where `replay` stands. The same recording and
/// limits give the same plan.
NextMotion PlanNextMotion(const Replay& replay, const Selection& selection,
                          const std::vector<std::vector<std::string>>& groups,
                          const MotionLimits& limits = {});

}  // namespace flextip::diagnosis
