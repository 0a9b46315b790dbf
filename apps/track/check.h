// The check of what flextip track is given.
#pragma once

#include <vector>

#include "apps/track/options.h"
#include "plausibility/finding.h"

namespace flextip {

/// Checks recording, camera, collar and a few pictures (CheckInput), and says where the camera's
/// pose is not known. A live source is not looked at. Returns the findings that do not stop the
/// command. Throws WorkError for the others.
std::vector<plausibility::Finding> CheckTrackInput(const TrackOptions& options, TrackInput& input,
                                                   bool quiet);

}  // namespace flextip
