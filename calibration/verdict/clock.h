// The clocks of a recording in words.
#pragma once

#include "calibration/clock/align_clocks.h"
#include "calibration/verdict/verdict.h"

namespace flextip {

/// Returns the head of the page.
CalibrationVerdict JudgeClocks(const ClockResult& result);

}  // namespace flextip
