// The spread of durations, counted without allocation.
#pragma once

#include <cstdint>
#include <vector>

#include "core/time_series.h"

namespace flextip::live {

/// Counts durations in steps of a microsecond, up to 0.1 s; longer ones by their number and the
/// longest.
class Spread {
 public:
  Spread() : counts_(kSteps, 0) {}

  void Add(TimeNs duration_ns);
  long Count() const { return count_; }
  double Worst_s() const { return worst_s_; }
  /// Returns the duration (s) below which `part` (0 to 1) of all are; 0 without any.
  double Quantile_s(double part) const;
  /// Returns the number of durations in [from_s, to_s).
  long Between(double from_s, double to_s) const;

 private:
  static constexpr std::size_t kSteps = 100'000;
  std::vector<std::uint32_t> counts_;
  long count_ = 0;
  double worst_s_ = 0.0;
};

}  // namespace flextip::live
