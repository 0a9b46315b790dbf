// Late stamps, put right as an extended model knows them.
#pragma once

#include "diagnosis/model/extended_model.h"
#include "recording/recording.h"

namespace flextip::diagnosis {

/// Returns `recording` without the latencies of `model`. A latency beyond tolerance moves a
/// stream's stamps to when its samples were taken. A latency within tolerance leaves the stamps,
/// so that samples of one instant stay together: it moves each sample along its path, by the
/// samples around it, and adds its standard deviation times the speed to the noise.
Recording WithoutLatency(Recording recording, const ExtendedModel& model,
                         const EffectMakers& own = {});

}  // namespace flextip::diagnosis
