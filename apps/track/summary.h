// The summary of flextip track.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/track/tables.h"
#include "pipeline/judge_track.h"
#include "recording/frames/track_input.h"

namespace flextip {

/// Counts, speed and residuals; with `scored` the errors against a truth, of the frames seen and of
/// those predicted.
nlohmann::json TrackSummary(const TrackSums& sums, int cameras, bool scored);

/// Returns what is judged of a run.
TrackTotals TrackTotalsOf(const TrackSums& sums, const TrackInput& input);

}  // namespace flextip
