// How large errors may be: the largest set of them that a part of the workspace can stand.
#pragma once

#include <limits>

#include "workspace/worst_case.h"

namespace flextip {

/// The bounds of the errors for which a measure stays below a limit all over a part of the
/// workspace.
template <int N>
struct ToleranceQuestion {
  ErrorBounds<N> bounds = {};  ///< their shape: the answer is a multiple of them
  Measure measure = Measure::kNorm;
  double limit = 1.0;
  VectorN<N> part_min = VectorN<N>::Constant(-std::numeric_limits<double>::infinity());
  VectorN<N> part_max = VectorN<N>::Constant(std::numeric_limits<double>::infinity());
};

enum class ToleranceStatus {
  kOk,
  kFailsAlready,  ///< the limit is passed with the setup's own errors: the scale is zero
  kNoLimit,       ///< no errors within 1000 times the bounds pass the limit
  kEmptyPart,     ///< no point of the map lies in the part
};
const char* Name(ToleranceStatus status);

template <int N>
struct Tolerance {
  ToleranceStatus status = ToleranceStatus::kEmptyPart;
  double scale = 0.0;        ///< largest multiple of the bounds that stays below the limit
  std::size_t point = 0;     ///< the map's point where the limit is passed first
  WorstError<N> first = {};  ///< the errors that pass the limit there, just above `scale`
  std::size_t points = 0;    ///< how many were looked at
};

/// Finds the scale by bisection to 1e-4 of it; a point that passes at a scale is not looked at
/// again below that. Uses all cores.
template <int N>
Tolerance<N> FindTolerance(const MapSetup<N>& setup, const WorkspaceMap<N>& map,
                           const ToleranceQuestion<N>& question);

}  // namespace flextip
