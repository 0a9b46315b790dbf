// The times of streams: rates, gaps, overlap, clocks, frozen and repeated samples.
#pragma once

#include <string>
#include <vector>

#include "plausibility/finding.h"
#include "plausibility/scene.h"
#include "recording/recording.h"

namespace flextip::plausibility {

/// A stream as rows of numbers.
struct Rows {
  std::string name;
  double stated_rate_hz = 0.0;
  std::vector<TimeNs> t_ns;
  std::vector<std::vector<double>> values;  ///< one a sample; empty where lost
  bool may_rest = false;                    ///< a load may be constant, a file name is no value
};

/// Returns every stream with samples.
std::vector<Rows> RowsOf(const Recording& recording);

/// Returns a stream's times beside those of `wrist` (null: none).
StreamFacts FactsOf(const Rows& rows, const Rows* wrist);

/// Finds time stamps in another unit, clocks that do not meet wrist0's, rates that are not as
/// stated, gaps and stuck values. Writes to `repaired` a copy with the time units undone, and to
/// `shifts` the clock corrections.
std::vector<Finding> CheckTimes(const Recording& recording, const std::vector<Rows>& rows,
                                Recording& repaired, Shifts& shifts);

/// Finds streams that lag behind the wrist's motion, from their speeds, or behind one another.
/// Adds the corrections to `shifts`.
std::vector<Finding> CheckLags(const Recording& recording, Shifts& shifts);

}  // namespace flextip::plausibility
