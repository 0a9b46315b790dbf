// The tracker with what wrist and shaft model expect.
#pragma once

#include <optional>

#include "apps/frame_sets.h"
#include "apps/tip_model.h"
#include "recording/recording.h"
#include "vision/tip_tracker.h"

namespace flextip {

class TipFollower {
 public:
  /// `recording` must outlive this. The model is used where `with_model` and the wrist was
  /// recorded.
  TipFollower(const Recording& recording, const TrackerOptions& options, bool with_model);

  TipTrack Follow(const FrameSet& frames);

 private:
  TipTracker tracker_;
  std::optional<TipModel> model_;
};

}  // namespace flextip
