// Decides when the shaft's outline is looked at, and when it is believed.
#pragma once

#include <optional>
#include <vector>

#include "vision/outline/tip_outline.h"
#include "vision/tracking/collar_localiser.h"
#include "vision/tracking/constant_velocity_filter.h"
#include "vision/tracking/options.h"

namespace flextip {

/// The outline in a tracker: joined to the tags while they are seen, followed alone while they are
/// covered, if it agreed with them before.
class OutlineFollower {
 public:
  /// Needs `options.tube`. Throws InputError as ShaftContour does.
  OutlineFollower(const std::vector<CameraCalibration>& cameras, const TrackerOptions& options);

  /// Joins the outline to the tags in `sight`, where the tags leave the direction uncertain and the
  /// outline's long base line is worth its time. Now and then the outline is looked at all the
  /// same: one that is not where the tags say (another diameter, another end) is not believed later
  /// without them.
  void Join(const std::vector<const Image*>& images, Sight& sight);

  /// Takes over the state of `filter` after the tags were seen at `t_ns`.
  void LeaveFrom(const ConstantVelocityFilter& filter, TimeNs t_ns);
  /// Forgets the tags, which were not seen for long.
  void Forget() { by_tags_.reset(); }

  /// Returns the pose by the outline alone, while it is believed. `expected` is the expected tip,
  /// earlier outlines included; `model` that of this frame by wrist and shaft, not from pictures.
  std::optional<TipPrediction> Follow(const std::vector<const Image*>& images, TimeNs t_ns,
                                      const TipPrediction& expected,
                                      const std::optional<TipPrediction>& model);

  /// Visits all that lasts from frame to frame.
  void VisitState(StateText& state);

 private:
  TipPrediction Prior(TimeNs t_ns, const TipPrediction& expected,
                      const std::optional<TipPrediction>& model) const;

  TrackerOptions options_;
  TipOutline outline_;
  std::optional<ConstantVelocityFilter> by_tags_;  // as the tags left it, before an outline came in
  TimeNs last_seen_ns_ = 0;                        // of the last tags
  double agreement_ = 0;                           // with the tags, fading
  int checks_ = 0, frames_since_ = 0;
};

}  // namespace flextip
