// What a sample costs, beside an estimate.
#pragma once

#include <cstdint>
#include <string>

namespace flextip::bench {

/// Processor time (s) of a cycle.
struct WatchCost {
  double mean_s = 0.0, p50_s = 0.0, p99_s = 0.0, worst_s = 0.0;  ///< of the running diagnosis
  int above = 0;                                                 ///< cycles above 200 us
  double estimate_mean_s = 0.0;  ///< of an estimate of the same sensors
  int cycles = 0;
};

/// Runs the press with all sensors, then its sensors through diagnosis and estimator.
WatchCost MeasureCost(std::uint64_t seed);

std::string CostText(const WatchCost& cost);

}  // namespace flextip::bench
