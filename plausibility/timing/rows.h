// A recording's streams as rows of numbers with their times.
#pragma once

#include <string>
#include <vector>

#include "plausibility/finding.h"
#include "recording/recording.h"

namespace flextip::plausibility {

/// A stream's samples.
struct Rows {
  std::string name;
  double stated_rate_hz = 0.0;
  std::vector<TimeNs> t_ns;
  std::vector<std::vector<double>> values;  ///< one a sample; empty where lost, and of pictures
  bool may_rest = false;                    ///< constant values are no fault: a load, a command
  double noise = 0.0;                       ///< stated, of the first number; 0: may be none
};

/// Returns every stream with samples.
std::vector<Rows> RowsOf(const Recording& recording);
/// Returns the stream of that name, or null.
const Rows* FindRows(const std::vector<Rows>& rows, const std::string& name);

/// Returns a stream's times beside those of `wrist` (null: none).
StreamFacts FactsOf(const Rows& rows, const Rows* wrist);

/// Returns the median step of the times; 0 with fewer than two.
double MedianStep_s(const Rows& rows);
/// Returns the seconds from `from_ns` to `to_ns`.
double SecondsBetween(TimeNs from_ns, TimeNs to_ns);
/// Returns a duration in words, in the unit that suits its size: "1.00 h", "12.3 s", "40 ms".
std::string DurationText(double seconds);

}  // namespace flextip::plausibility
