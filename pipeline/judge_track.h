// Judges whether a tip was tracked: the head of track's page.
#pragma once

#include "core/judgement.h"
#include "pipeline/track_totals.h"

namespace flextip {

/// Judges totals of at least one frame: not found where no frame showed the tip; to be used with
/// care where it was seen in less than half of them, where tags contradict wrist, collar or time,
/// where the corners are far from the fit, and where the camera's pose is not known.
Judgement JudgeTrack(const TrackTotals& totals);

}  // namespace flextip
