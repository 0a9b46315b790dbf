// The tracker with what wrist and shaft model expect, and with the tip beyond the collar.
#pragma once

#include <optional>
#include <string>

#include "kinematics/tip_bending.h"
#include "pipeline/tip_predictor.h"
#include "recording/frames/frame_sets.h"
#include "recording/recording.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip {

class TipFollower {
 public:
  /// `recording` must outlive this. The model is used where `with_model` and the wrist was
  /// recorded. Where the load is known (load0), the shaft bends beyond the collar.
  TipFollower(const Recording& recording, const TrackerOptions& options, bool with_model);

  TipTrack Follow(const FrameSet& frames);

  /// What is needed to go on in another run. A run that is to give the same results must have asked
  /// for it after the same frames: the model's solvers start afresh there.
  std::string State();
  /// Throws InputError where `state` is not of a follower with the same options.
  void SetState(const std::string& state);

 private:
  void VisitState(StateText& state);
  /// From the rigid collar's tip to the true one; the identity where the load is not known.
  struct Bend {
    Pose T_EE;
    Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Zero();  ///< in R
  };
  Bend BendAt(TimeNs t_ns, const Pose& T_RE) const;

  const Recording* recording_;
  FreeEnd beyond_collar_;
  TipTracker tracker_;
  std::optional<TipModel> model_;
};

}  // namespace flextip
