// The clocks of a recording in words.
#pragma once

#include "calibration/clock/align_clocks.h"
#include "calibration/verdict/verdict.h"

namespace flextip {

/// Returns the head of the page. `recording` is for the command of the next step.
CalibrationVerdict JudgeClocks(const ClockResult& result, const std::string& recording);

}  // namespace flextip
