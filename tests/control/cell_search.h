// The largest angle between desired and actual motion by subdivision, with proof.
#pragma once

#include <Eigen/Dense>

#include "bench/sphere_search.h"

namespace flextip {

struct CellSearchResult {
  bool decided = false;  ///< false: more cells than allowed were needed
  bool raised = false;   ///< larger than what the search started from
  long cells = 0;
  double angle = 0.0;  ///< rad; the largest is not more than `tolerance` above it
};

/// Starts from the angle (0 to pi) of a direction that is known and looks at all others. These are
/// cut into cells; a cell is dropped where its angles are shown to be less than the largest so far
/// + tolerance: on it dot product, cross product and squared norms of H w and T w are polynomials,
/// and a polynomial is positive where its Bernstein coefficients are. The rest are cut on, the
/// largest first, until none is left. A corner that is larger is refined and raises the limit for
/// all others. Nothing is known of where maxima are. N = 2 or 3, H and T as in `MotionPair`.
template <int N>
CellSearchResult SearchCells(const MotionPair<N>& pair, double start_angle, double tolerance);

}  // namespace flextip
