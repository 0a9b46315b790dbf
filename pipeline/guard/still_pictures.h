// Whether the pictures stand still while the instrument moves.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/image.h"
#include "core/state_text.h"
#include "estimation/measurements.h"

namespace flextip {

/// A camera, a grabber or a network that hands on the last picture again shows a tip of the past.
/// Two pictures of a sensor are never the same pixel for pixel, but for rendered ones at rest.
class StillPictures {
 public:
  /// Returns whether `images` (null: none) are those of the last call, pixel for pixel, and the
  /// wrist was elsewhere when they first came: by 0.2 mm, and by ten times its noise.
  bool Look(const std::vector<const Image*>& images, const std::optional<Measurements>& measured);

  void VisitState(StateText& state);

 private:
  std::int64_t pixels_ = 0;  // a hash of all of them; 0: none yet
  std::optional<Eigen::Vector3d> first_p_RW_;
};

}  // namespace flextip
