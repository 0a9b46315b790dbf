// Which of several lags is a stream's: of a motion that repeats, each period is one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plausibility/scene.h"
#include "plausibility/timing/lag.h"

namespace flextip::plausibility {

inline constexpr double kLatency_s = 0.25;  ///< sensors' latencies stay below

/// Returns the lag among `lags` (the best first) after which `stream` fits the other streams best,
/// by its relations to them; those that correlate far worse than the best do not count. Where
/// several fit alike, the one that is nearest to `expected_s`. Empty without lags.
std::optional<Lag> ChooseLag(const Recording& recording, const std::string& stream,
                             const std::vector<Lag>& lags, const Shifts& shifts,
                             const std::set<std::string>& unknown, double expected_s = 0.0);

}  // namespace flextip::plausibility
