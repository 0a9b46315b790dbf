// Stretches of one session as one recording.
#pragma once

#include <vector>

#include "recording/recording.h"

namespace flextip {

/// Returns the recordings one after the other, as if they had been made without a break: each one's
/// time goes on a wrist period after the end of the one before it. A weight may have been hung in
/// between, so what sensors of the shaft say in the first `settle_s` of a later stretch is left
/// out: it may be of the time before. What a sensor says of itself is taken from the first
/// recording that has it; a camera keeps its calibration and loses the frames. At least one
/// recording of a shaft, each with a wrist0; joints are not taken.
Recording Join(const std::vector<const Recording*>& stretches, double settle_s = 0.25);

}  // namespace flextip
