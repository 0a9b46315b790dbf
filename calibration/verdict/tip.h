// Judges where a tip was found, by its pivot calibration.
#pragma once

#include <string>

#include "calibration/tip/pivot.h"
#include "calibration/verdict/verdict.h"

namespace flextip {

/// Returns which turn would help most, in words. `body`: the letter of the frame that was turned,
/// "W", "S" or "E".
std::string AdviceText(const PivotResult& result, const std::string& body);

/// Judges a pivot; `tip_name` as in calibration.yaml: "tip.p_WE", "tip.p_SE" or "tags0.p_E".
CalibrationVerdict JudgeTip(const PivotResult& result, const std::string& tip_name,
                            const std::string& body);

}  // namespace flextip
