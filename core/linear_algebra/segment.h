// The nearest place on a segment.
#pragma once

#include <Eigen/Dense>
#include <algorithm>

namespace flextip {

/// Returns the place on the segment from `a` to `b` that is nearest to `p`. Any frame and unit.
inline Eigen::Vector3d NearestOnSegment(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                        const Eigen::Vector3d& p) {
  const Eigen::Vector3d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double part = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return a + part * ab;
}

}  // namespace flextip
