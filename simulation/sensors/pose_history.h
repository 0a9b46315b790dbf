// A pose's recent past, for sensors whose samples are stamped late.
#pragma once

#include <deque>

#include "core/pose.h"
#include "core/time_series.h"

namespace flextip::simulation {

/// The last second of a pose. Between the entries it is the cubic through the four around the time,
/// for the orientation in the rotation vector from the nearest one; before the first it is the
/// first, after the last it is the last.
class PoseHistory {
 public:
  /// Adds a pose. Times increase; a pose at the last time replaces the last.
  void Add(TimeNs t_ns, const Pose& pose);
  /// Returns the pose at `t_ns`. Needs an entry.
  Pose At(TimeNs t_ns) const;

 private:
  std::deque<Sample<Pose>> entries_;
};

}  // namespace flextip::simulation
