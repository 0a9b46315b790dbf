// The worst that a set of possible errors can do: bounded errors as a design tool (thesis 2.4).
#pragma once

#include <vector>

#include "workspace/map.h"

namespace flextip {

enum class BoundShape { kBox, kEllipsoid };

/// The controller's errors are those of the setup plus any in this set, `half_width` from it (none
/// of its components negative).
template <int N>
struct ErrorBounds {
  BeliefError<N> half_width = {};
  BoundShape shape = BoundShape::kBox;
};

template <int N>
struct WorstError {
  double value = 0.0;         ///< largest value of the measure; infinite and pi: see FindWorst
  BeliefError<N> error = {};  ///< error of the set, added to the setup's
};

/// Returns the largest value of the measure at a state, over `scale` times the bounds, by a climb
/// in ever smaller steps from all corners (of the box, or the directions toward them). Where the
/// set holds a controller whose Jacobian is singular, the value is infinite, or pi for an angle.
template <int N>
WorstError<N> FindWorst(const MapSetup<N>& setup, const TrueState<N>& state,
                        const ErrorBounds<N>& bounds, Measure measure, double scale = 1.0);

/// Returns FindWorst at every point of the map that the tip can reach, in the map's order; NaN
/// elsewhere. Uses all cores.
template <int N>
std::vector<double> WorstOverMap(const MapSetup<N>& setup, const WorkspaceMap<N>& map,
                                 const ErrorBounds<N>& bounds, Measure measure);

}  // namespace flextip
