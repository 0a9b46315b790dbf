// A verdict as it stands under `verdict` in summary.json (docs/formats.md).
#pragma once

#include <nlohmann/json.hpp>

#include "calibration/verdict/verdict.h"

namespace flextip {

nlohmann::json VerdictJson(const CalibrationVerdict& verdict);

/// Returns a list of {"parameter", "reason"}.
nlohmann::json UnobservableJson(const std::vector<Calibration::Unobservable>& unobservable);

}  // namespace flextip
