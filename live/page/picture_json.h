// The laparoscope's picture for the page, and what lies over it, in pixels. Private to live/page/.
#pragma once

#include <string>

#include "live/page/findings.h"
#include "vision/camera_model.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip::live {

/// Returns message number `n`, of the picture of `t_ns`, as JSON: the tags' corners, the tip with
/// its doubt and its frame as seen in the picture, and the estimate's shaft and the goal of the
/// `moment` nearest to it, as far as `camera` sees them. Pixel (0, 0) is the middle of the first.
std::string OverlayText(long n, TimeNs t_ns, const CameraModel& camera, const TipTrack& track,
                        const ShaftMoment& moment);

}  // namespace flextip::live
