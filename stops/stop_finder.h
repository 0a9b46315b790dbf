// The stops in a run: when its supervisor held the robot, and when that became a fault.
#pragma once

#include <string>
#include <vector>

#include "control/supervision/stops.h"
#include "core/time_series.h"

namespace flextip {

/// A cycle of a run, as stops are found in it.
struct WatchedCycle {
  TimeNs t_ns = 0;
  const char* cause = "";  ///< the name of what holds; empty: nothing does
  bool fault = false;      ///< only a person ends it
  bool begun = false;      ///< the run's motion has begun: holds before do not count
};

/// One stop: a fault with the hold that became it, or the first hold of a run of holds.
struct StopEvent {
  TimeNs begin_ns = 0;  ///< when the hold began
  TimeNs fault_ns = 0;  ///< when it became a fault; 0: it did not
  TimeNs end_ns = 0;    ///< of the last cycle held
  std::string cause;    ///< "tip_disagrees": of the fault, else of the hold's begin
  int holds = 1;        ///< of the run
  bool open = false;    ///< the recording ends held

  bool IsFault() const { return fault_ns != 0; }
};

/// Finds the stops of cycles that are given in order. A hold that comes within ten seconds after
/// another is of the same run.
class StopFinder {
 public:
  void Add(const WatchedCycle& cycle);
  /// Returns the stops, in order of time.
  std::vector<StopEvent> Stops() const;

 private:
  std::vector<StopEvent> stops_;
  WatchedCycle last_;
  TimeNs hold_began_ns_ = 0;
  bool in_stop_ = false;  // the hold that lasts belongs to the last stop
};

/// Returns the stops by their weight, at most `most`: faults first, then those that held longest.
std::vector<StopEvent> Gravest(std::vector<StopEvent> stops, std::size_t most);

}  // namespace flextip
