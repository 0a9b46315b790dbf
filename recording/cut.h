// A stretch of a recording.
#pragma once

#include "recording/recording.h"

namespace flextip {

/// Returns the recording from `from_ns` to `to_ns`, both included. A stream without a sample in it
/// is left out; a camera keeps its calibration and loses the frames.
Recording Cut(const Recording& recording, TimeNs from_ns, TimeNs to_ns);

/// Leaves out the pictures; the cameras keep their calibrations.
void DropFrames(Recording& recording);

}  // namespace flextip
