// The shaft's recent past, for pictures that are stamped late.
#pragma once

#include <deque>

#include "core/time_series.h"
#include "simulation/plant/shaft_curve.h"

namespace flextip::simulation {

/// The last seconds of a shaft. Between two entries every point goes straight; before the first it
/// is the first, after the last it is the last.
class CurveHistory {
 public:
  /// Keeps what is up to `seconds` old; 0: the newest curve alone.
  explicit CurveHistory(double seconds);
  /// Adds a curve, with as many points as the others. Times increase; a curve at the last time
  /// replaces the last.
  void Add(TimeNs t_ns, ShaftCurve curve);
  /// Returns the curve of `seconds` before `t_ns`. Needs an entry.
  ShaftCurve Before(TimeNs t_ns) const;

 private:
  TimeNs span_ns_;
  std::deque<Sample<ShaftCurve>> entries_;
};

}  // namespace flextip::simulation
