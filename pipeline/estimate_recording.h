// The instrument's load, port and shape at every sample of a recording.
#pragma once

#include <functional>

#include "estimation/instrument_model.h"
#include "pipeline/instrument_estimator.h"
#include "recording/recording.h"

namespace flextip {

/// Returns the estimates at all times of the wrist and the tip, by `estimator`, which is new.
/// `model`: how instrument and sensors differ from their data; null: as their data say. The streams
/// are taken as they are stamped. `progress` is told how many of all times are done.
Series<ShaftEstimate> EstimateRecording(
    const Recording& recording, InstrumentEstimator& estimator, InstrumentModel* model = nullptr,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace flextip
