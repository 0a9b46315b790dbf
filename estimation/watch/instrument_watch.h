// What watches a running loop for causes of misfit. Implemented where the causes are known
// (diagnosis/running), so that the loop needs to know none.
#pragma once

#include <array>
#include <cstdint>

#include "core/time_series.h"
#include "estimation/measurements.h"
#include "estimation/shaft_change.h"

namespace flextip {

/// The sensors at one time, as the loop uses them.
struct WatchedMoment {
  TimeNs t_ns = 0;
  const Measurements& measurements;
  /// When em0, em1, strain and load were sampled: a sample counts once.
  std::array<TimeNs, 4> sampled_ns{};
  const ShaftChange& change;  ///< of the found model, where there is one
};

/// A cause, by its number in the watch's list, and its size in SI units.
struct SizedCause {
  std::int8_t cause = -1;  ///< -1: none
  double value = 0.0, sd = 0.0;
};

/// What a watch has found. Fixed size.
struct FoundCause {
  SizedCause likeliest, other;  ///< `other` explains the sensors as well; cause -1: none does
  bool has_more = false;        ///< further causes explain them as well
  /// Logarithm of how much more probable the sensors are with the cause than within tolerance.
  double log_evidence = 0.0;
  TimeNs found_ns = 0;
  TimeNs since_ns = 0;  ///< when it set in; 0: it was there from the start

  bool IsThere() const { return likeliest.cause >= 0; }
};

/// A cause that was named, and when.
struct Warning {
  TimeNs t_ns = 0;
  FoundCause cause;
};

/// Returns whether `now` names another cause than `last`, or the first one.
inline bool IsNews(const FoundCause& now, const FoundCause& last) {
  return now.likeliest.cause != last.likeliest.cause || now.other.cause != last.other.cause;
}

class InstrumentWatch {
 public:
  virtual ~InstrumentWatch() = default;
  /// Takes the sensors of a moment, not before the last one. At most one call a cycle counts.
  virtual void Look(const WatchedMoment& moment) = 0;
  /// Does a cycle's share of the work. Bounded, allocates nothing.
  virtual void Work() = 0;
  /// Returns the cause, once there is one.
  virtual const FoundCause& Found() const = 0;

 protected:
  InstrumentWatch() = default;
  InstrumentWatch(const InstrumentWatch&) = default;
  InstrumentWatch& operator=(const InstrumentWatch&) = default;
};

}  // namespace flextip
