// The session's calibrations on one sample, as on a recording.
#pragma once

#include "live/streams/samples.h"

namespace flextip::live {

/// Returns the sample with the session's calibrations applied. Allocates where there are any: call
/// it on the thread that delivers the stream.
Arrived<AnySample> Calibrate(const Session& session, StreamName stream,
                             const Arrived<AnySample>& sample);

}  // namespace flextip::live
