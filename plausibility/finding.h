// What a check finds in a recording.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/time_series.h"

namespace flextip::plausibility {

enum class Severity : std::uint8_t {
  kWrong,     ///< the recording cannot be as it says
  kDoubtful,  ///< it can, but rarely is
};
/// "wrong", "doubtful".
const char* Name(Severity severity);

/// One thing that does not fit, and the line that mends it.
struct Finding {
  Severity severity = Severity::kWrong;
  std::string id;    ///< subject and kind: "em0.unit"
  std::string text;  ///< with numbers
  std::string mend;  ///< empty where no line is known

  /// Returns the id up to its first dot: "em0", "port", "instrument".
  std::string Subject() const { return id.substr(0, id.find('.')); }
};

/// Puts the wrong findings before the doubtful ones and drops all but the first of each id.
void SortFindings(std::vector<Finding>& findings);

/// A stream's times.
struct StreamFacts {
  std::string name;
  std::size_t samples = 0;
  TimeNs first_ns = 0, last_ns = 0;
  double median_rate_hz = 0.0;  ///< 0 with fewer than two samples
  double stated_rate_hz = 0.0;  ///< 0: not stated
  double largest_gap_s = 0.0;
  double overlap_with_wrist = 0.0;  ///< share of the samples that lie within wrist0's times
};

struct CheckResult {
  std::vector<StreamFacts> streams;
  std::vector<Finding> findings;  ///< the wrong ones first

  bool AnythingWrong() const {
    for (const Finding& f : findings)
      if (f.severity == Severity::kWrong) return true;
    return false;
  }
};

}  // namespace flextip::plausibility
