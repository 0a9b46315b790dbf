// What a control run says at its end: as JSON and as tables.
#pragma once

#include <nlohmann/json.hpp>

#include "live/loop/control_loop.h"

namespace flextip {

/// Returns the summary of a run. `only_timing`: of one that moved nothing.
nlohmann::ordered_json ReportJson(const live::Session& session, const live::LoopReport& report,
                                  bool only_timing);

/// Prints how the run went.
void PrintRun(const live::LoopReport& report);
/// Prints rates, times and their histogram.
void PrintTimes(const live::LoopReport& report);

}  // namespace flextip
