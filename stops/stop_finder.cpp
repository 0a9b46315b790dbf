#include "stops/stop_finder.h"

#include <algorithm>

namespace flextip {
namespace {

constexpr TimeNs kRun_ns = 10'000'000'000;  // holds nearer each other are one run

}  // namespace

void StopFinder::Add(const WatchedCycle& cycle) {
  const bool held = *cycle.cause != '\0';
  const bool was_held = *last_.cause != '\0';
  if (held && !was_held) {
    hold_began_ns_ = cycle.t_ns;
    in_stop_ = cycle.begun;
    const bool same_run =
        !stops_.empty() && cycle.t_ns - stops_.back().end_ns < kRun_ns && cycle.begun;
    if (same_run) {
      ++stops_.back().holds;
    } else if (cycle.begun) {
      stops_.push_back({cycle.t_ns, 0, cycle.t_ns, cycle.cause});
    }
  }
  if (cycle.fault && !last_.fault) {
    // A fault is a stop of its own, with the hold that became it.
    const bool has_stop = in_stop_ && !stops_.empty() && !stops_.back().IsFault();
    if (!has_stop) stops_.push_back({});
    StopEvent& stop = stops_.back();
    stop.begin_ns = held && was_held ? hold_began_ns_ : cycle.t_ns;
    stop.fault_ns = cycle.t_ns;
    stop.cause = cycle.cause;
    in_stop_ = true;
  }
  if (held && in_stop_) stops_.back().end_ns = cycle.t_ns;
  if (!stops_.empty()) stops_.back().open = held && in_stop_;
  last_ = cycle;
}

std::vector<StopEvent> StopFinder::Stops() const { return stops_; }

std::vector<StopEvent> Gravest(std::vector<StopEvent> stops, std::size_t most) {
  std::stable_sort(stops.begin(), stops.end(), [](const StopEvent& a, const StopEvent& b) {
    if (a.IsFault() != b.IsFault()) return a.IsFault();
    return a.end_ns - a.begin_ns > b.end_ns - b.begin_ns;
  });
  if (stops.size() > most) stops.resize(most);
  return stops;
}

}  // namespace flextip
