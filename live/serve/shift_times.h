// Another zero of time for a recording. Private to serve.
#pragma once

#include "recording/recording.h"
#include "recording/truth.h"

namespace flextip::live {

/// Adds `offset_ns` to the time of every sample.
void ShiftTimes(TimeNs offset_ns, Recording& recording, Series<TruthSample>& truth);

}  // namespace flextip::live
