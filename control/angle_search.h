// The largest angle between v and A v: the search along the pencil's line (`angle_pencil.h`).
#pragma once

#include <Eigen/Dense>

#include "control/angle_pencil.h"

namespace flextip {

/// A direction in the pencil's form and its angle.
struct AngleCandidate {
  double x = 1.0;
  Eigen::Vector3d y = Eigen::Vector3d::UnitX();
  double angle = -1.0;  ///< rad; negative: none yet

  /// Takes this direction if its angle is larger.
  void Offer(const AnglePencil& pencil, double at_x, const Eigen::Vector3d& at_y) noexcept;
};

/// Up to 90 degrees, where K's least eigenvalue is positive: it has a single maximum over x,
/// between `low` (balance not negative) and `high` (not positive). Good to 1e-13 rad.
AngleCandidate SearchAcute(const AnglePencil& pencil, PencilPoint low, PencilPoint high) noexcept;

/// Past 90 degrees, where it is negative and can have several minima. Climbs from `start`, then
/// proves that nothing is larger by 1e-10 rad (by 2e-14 of the cosine within 1e-4 rad of pi), or
/// climbs from what is. False if bounded work was not enough; `best` is then what was found.
bool SearchObtuse(const AnglePencil& pencil, const PencilPoint& start,
                  AngleCandidate& best) noexcept;

}  // namespace flextip
