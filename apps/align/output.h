// The files of flextip align.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "calibration/clock/align_clocks.h"
#include "report/figure.h"

namespace flextip {

/// summary.json's `reference` and `streams`.
nlohmann::json ClockSummary(const ClockResult& result);
/// For each stream the speeds of both before and after, and the misfit against the offset.
std::vector<report::Figure> ClockFigures(const Recording& recording, const ClockResult& result);

}  // namespace flextip
