// How far one quantity lags behind another.
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <optional>
#include <vector>

#include "core/time_series.h"

namespace flextip::plausibility {

/// Up to three numbers at a time (the others zero); empty where they are not known.
using VectorAt = std::function<std::optional<Eigen::Vector3d>(TimeNs)>;

struct Lag {
  double seconds = 0.0;  ///< the second quantity at t + seconds goes with the first at t
  double correlation = 0.0, correlation_at_zero = 0.0;  ///< at zero 0 where too few are common

  /// Returns whether the lag explains far more than no lag does.
  bool IsClear() const;
};

struct LagSearch {
  TimeNs begin_ns = 0, end_ns = 0;  ///< times of the first quantity
  double around_s = 0.0, reach_s = 60.0;
};

/// Returns the lags at which the correlation is best of those around, to 0.02 s, the best first; up
/// to twelve, of a correlation of 0.5 and more. A motion that repeats has several. Empty with fewer
/// than 30 common times, or fewer than 0.4 of those that are known of `a`.
std::vector<Lag> FindLags(const VectorAt& a, const VectorAt& b, const LagSearch& search);

}  // namespace flextip::plausibility
