// Runs of the closed loop for the running diagnosis: healthy ones, and ones in which a cause sets
// in.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/fault_campaign/base.h"

namespace flextip::bench {

/// The causes that set in, by the names of docs/effects.md, and em_offset.
const std::vector<std::string>& OnsetCauses();

/// Of the typical size of the cause in the diagnosis.
inline constexpr double kOnsetSizes[] = {0.2, 0.6, 2.0};
inline constexpr const char* kOnsetSizeNames[] = {"subtle", "plain", "strong"};
inline constexpr int kOnsetSizeCount = 3;

struct WatchedRun {
  simulation::LoopSetup setup;  ///< with the watch
  Suite suite = Suite::kAll;
  std::string cause;  ///< empty: none
  int size = 0;       ///< index of kOnsetSizes
  double onset_s = 0.0;
};

/// Returns a run of `duration_s` without a cause: another path, speed, tissue and instrument each
/// time, all within tolerance.
WatchedRun DrawWatched(std::uint64_t seed, int number, Suite suite, double duration_s,
                       double false_alarms_per_hour);

/// Returns a run in which `cause` sets in at a random moment from 20 to 40 s on, in the same way.
WatchedRun DrawOnset(std::uint64_t seed, int number, const std::string& cause, int size,
                     double duration_s, double false_alarms_per_hour);

}  // namespace flextip::bench
