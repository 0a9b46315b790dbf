// Judges whether a tip was tracked: the head of track's page.
#pragma once

#include <string>

#include "core/judgement.h"
#include "recording/tip_score.h"

namespace flextip {

/// What the frames of a run say together.
struct TrackTotals {
  long frames = 0, ok = 0, predicted = 0, lost = 0, tags = 0;
  double rms_px = 0.0;          ///< of the corners about the fit; 0 where pixels were fitted
  std::string family = {};      ///< of the collar's tags
  bool camera_has_pose = true;  ///< else the tips are in the camera's frame
  TipScore score = {};          ///< of the ok frames, where there is a truth
};

/// Judges totals of at least one frame: not found where no frame showed the tip; to be used with
/// care where it was seen in less than half of them, where the corners are far from the fit, and
/// where the camera's pose is not known.
Judgement JudgeTrack(const TrackTotals& totals);

}  // namespace flextip
