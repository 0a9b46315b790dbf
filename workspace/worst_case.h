// The worst that a set of possible errors can do: bounded errors as a design tool (thesis 2.4).
#pragma once

#include <limits>
#include <vector>

#include "workspace/map.h"

namespace flextip {

enum class BoundShape { kBox, kEllipsoid };

/// The controller's errors are those of the setup plus any in this set, `half_width` from it (none
/// of its components negative).
template <int N>
struct ErrorBounds {
  ModelError<N> half_width;
  BoundShape shape = BoundShape::kBox;
};

template <int N>
struct WorstError {
  double value = 0.0;   ///< of the measure; see FindWorst for what infinite and pi mean
  ModelError<N> error;  ///< of the set, added to the setup's
};

/// The largest value of the measure at one state, over `scale` times the bounds: from all corners
/// (of the box, or the directions toward them) a climb in ever smaller steps. Where the set holds a
/// controller whose Jacobian is singular, the value is infinite, or pi of an angle.
template <int N>
WorstError<N> FindWorst(const MapSetup<N>& setup, const TrueState<N>& state,
                        const ErrorBounds<N>& bounds, Measure measure, double scale = 1.0);

/// FindWorst at every point of the map that the tip can reach, in the map's order; NaN elsewhere.
/// Uses all cores.
template <int N>
std::vector<double> WorstOverMap(const MapSetup<N>& setup, const WorkspaceMap<N>& map,
                                 const ErrorBounds<N>& bounds, Measure measure);

/// What the errors must keep to so that a measure stays below a limit all over a part of the
/// workspace.
template <int N>
struct ToleranceQuestion {
  ErrorBounds<N> bounds;  ///< their shape: the answer is a multiple of them
  Measure measure = Measure::kNorm;
  double limit = 1.0;
  VectorN<N> part_min = VectorN<N>::Constant(-std::numeric_limits<double>::infinity());
  VectorN<N> part_max = VectorN<N>::Constant(std::numeric_limits<double>::infinity());
};

enum class ToleranceStatus {
  kOk,
  kFailsAlready,  ///< the limit is passed with the setup's own errors: the scale is zero
  kNoLimit,       ///< nothing within 1000 times the bounds passes it
  kEmptyPart,     ///< no point of the map lies in the part
};
const char* Name(ToleranceStatus status);

template <int N>
struct Tolerance {
  ToleranceStatus status = ToleranceStatus::kEmptyPart;
  double scale = 0.0;     ///< largest multiple of the bounds that stays below the limit
  std::size_t point = 0;  ///< of the map, where the limit is passed first
  WorstError<N> first;    ///< what passes it there, at `scale` and a little more
  std::size_t points = 0;  ///< how many were looked at
};

/// By bisection to 1e-4 of the scale; a point that passes at one scale is not looked at again below
/// it. Uses all cores.
template <int N>
Tolerance<N> FindTolerance(const MapSetup<N>& setup, const WorkspaceMap<N>& map,
                           const ToleranceQuestion<N>& question);

}  // namespace flextip
