// A collar in words: what it is, how well it will be seen, what to do next.
#pragma once

#include <vector>

#include "calibration/verdict/verdict.h"
#include "targets/collar/accuracy.h"
#include "targets/collar/design.h"

namespace flextip {

/// Returns the head of the page. Needs at least one distance.
CalibrationVerdict JudgeCollar(const CollarDesign& design, const ViewingConditions& conditions,
                               const std::vector<AccuracyAtDistance>& accuracy);

}  // namespace flextip
