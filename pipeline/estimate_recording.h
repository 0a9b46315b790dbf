// The instrument's load, port and shape at every sample of a recording.
#pragma once

#include <functional>

#include "estimation/instrument_model.h"
#include "estimation/shaft_estimator.h"
#include "recording/recording.h"

namespace flextip {

/// `model`, where there is one, says how instrument and sensors differ from their data; the
/// recording's streams are taken as they are stamped. `progress` is told how many of all are done.
Series<ShaftEstimate> EstimateRecording(
    const Recording& recording, const EstimatorOptions& options, InstrumentModel* model = nullptr,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace flextip
