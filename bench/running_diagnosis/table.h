// What the running diagnosis says of runs, and the figures of that.
#pragma once

#include <string>
#include <vector>

#include "bench/running_diagnosis/draw.h"

namespace flextip::bench {

struct WatchedRecord {
  std::string cause, size, suite;  ///< cause empty: healthy
  std::string ended;               ///< why the run ended early; empty: it did not
  double simulated_s = 0.0;
  double onset_s = 0.0;
  double warned_s = -1.0;               ///< of the run; -1: never
  std::string first_names, last_names;  ///< "port_compliance or port_offset"
  std::string text;                     ///< of the last state
  double value = 0.0, sd = 0.0;

  bool Warned() const { return warned_s >= 0.0; }
  bool WarnedTooEarly() const { return Warned() && (cause.empty() || warned_s < onset_s); }
};

/// Runs the loop and notes the watch's word.
WatchedRecord RunWatched(const WatchedRun& run);

std::string CsvText(const std::vector<WatchedRecord>& records);
/// Returns the tables: by cause and size, by suite, and false alarms.
std::string OnsetTable(const std::vector<WatchedRecord>& records);
std::string HealthyTable(const std::vector<WatchedRecord>& records);

}  // namespace flextip::bench
