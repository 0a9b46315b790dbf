// The summary of flextip track.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "pipeline/track_totals.h"

namespace flextip {

/// Counts, speed and residuals; with `scored` the errors against a truth, of the frames seen and of
/// those predicted.
nlohmann::json TrackSummary(const TrackSums& sums, int cameras, bool scored);

}  // namespace flextip
