// The tracker with what wrist and shaft model expect.
#pragma once

#include <optional>
#include <string>

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

  /// What is needed to go on in another run. A run that is to give the same results must have asked
  /// for it after the same frames: the model's solvers start afresh there.
  std::string State();
  /// Throws InputError where `state` is not of a follower with the same options.
  void SetState(const std::string& state);

 private:
  void VisitState(StateText& state);

  TipTracker tracker_;
  std::optional<TipModel> model_;
};

}  // namespace flextip
