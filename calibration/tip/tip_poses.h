// The poses of a recording that a pivot calibration takes.
#pragma once

#include <optional>
#include <vector>

#include "calibration/tip/pivot.h"
#include "recording/recording.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {

/// Every sample of wrist0 that has an orientation, with the stated noise (0.1 mm and 1 mrad where
/// none is stated). Empty where there are none.
std::vector<PivotPose> WristPoses(const Recording& recording);
/// Every sample of em0, in whatever frame it was recorded.
std::vector<PivotPose> EmPoses(const Recording& recording);
/// The collar's frame E as one frame shows it, with the tracker's covariance; empty where it was
/// not seen well, or another pose fits as well.
std::optional<PivotPose> CollarPivotPose(const TipTrack& track, TimeNs t_ns);

}  // namespace flextip
