// Judges where an EM system was found to stand.
#pragma once

#include <string>

#include "calibration/em/em_calibration.h"
#include "calibration/verdict/verdict.h"

namespace flextip {

CalibrationVerdict JudgeEm(const EmResult& result);

/// Returns how far sensor and reference are apart in time, in words; empty where they are not.
std::string LagText(const EmResult& result);

}  // namespace flextip
