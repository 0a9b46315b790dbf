// From a recording's streams to what estimation takes: the sensors at one instant.
#pragma once

#include <optional>
#include <vector>

#include "estimation/measurements.h"
#include "recording/recording.h"

namespace flextip {

/// Every time at which the wrist or the tip was sampled, in order.
std::vector<TimeNs> EstimationTimes(const Recording& recording);

/// The sensors at `t_ns`, interpolated where their samples lie beside it; the tip by vision only at
/// the times of its own frames. Empty where the wrist is not known.
std::optional<Measurements> MeasurementsAt(const Recording& recording, TimeNs t_ns);

}  // namespace flextip
