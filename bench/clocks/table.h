// How far the clocks that are found are off, and whether the stated deviations are true.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/clocks/session.h"
#include "calibration/clock/align_clocks.h"

namespace flextip::bench {

/// One stream of one session.
struct ClockRow {
  std::string session, stream;
  bool found = false;
  std::string reason = {};  ///< where it was refused
  double error_s = 0.0, sd_s = 0.0, rate_error = 0.0, rate_sd = 0.0;
};

/// Aligns a session and compares with the truth.
std::vector<ClockRow> MeasureSession(const ClockSession& session);

/// Rows of the same kind of session as lines of a Markdown table, a stream each.
std::string MarkdownLines(const std::string& kind, const std::vector<ClockRow>& rows);
std::string MarkdownHead();

}  // namespace flextip::bench
