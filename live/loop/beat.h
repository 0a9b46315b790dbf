// When a cycle is to run: at the beats of a clock, or at the robot's lockstep messages.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>

#include "core/time_series.h"

namespace flextip::live {

struct Beat {
  TimeNs t_ns = 0;    ///< the cycle's time
  TimeNs due_ns = 0;  ///< when it was to begin, and did (1970)
  TimeNs woke_ns = 0;
};

/// Beats of the machine's clock at a fixed rate. A beat that is past when its turn comes is missed,
/// and the later ones stay where they are.
class ClockBeats {
 public:
  explicit ClockBeats(double rate_hz);

  /// Waits for the next beat.
  Beat Next();
  long Missed() const { return missed_; }

 private:
  TimeNs period_ns_;
  TimeNs due_ns_;  // of the machine's own clock, which nobody sets
  long missed_ = 0;
};

/// Beats that another thread gives.
class GivenBeats {
 public:
  void Give(TimeNs t_ns, TimeNs arrived_ns);
  /// Waits for a beat, 50 ms at most.
  std::optional<Beat> Next();

 private:
  std::mutex mutex_;
  std::condition_variable there_;
  std::deque<Beat> beats_;
};

}  // namespace flextip::live
