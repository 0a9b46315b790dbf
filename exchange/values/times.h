// Times in tables: decimal numbers of any length, and clock texts, as whole nanoseconds.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/time_series.h"

namespace flextip::exchange {

/// A decimal number of `unit` ("s", "ms", "us", "ns") in ns, rounded to the nearest: exact where a
/// double would not be. Empty for anything else.
std::optional<TimeNs> DecimalTime(std::string_view text, const std::string& unit);

struct ClockTime {
  TimeNs t_ns = 0;  ///< since 1970, or since midnight where there is no date
  bool has_date = false, has_zone = false;
};
/// ISO 8601: 2024-05-01T12:00:00.123, with a blank for the T, a comma for the point, Z or an offset
/// (+02:00), or the time of day alone.
std::optional<ClockTime> ParseClock(std::string_view text);

/// A time of a table: `unit` as above, or "clock".
std::optional<TimeNs> ParseTime(std::string_view text, const std::string& unit);

/// Returns a time with an offset added; empty where the sum is beyond what a recording holds.
std::optional<TimeNs> WithOffset(TimeNs t_ns, TimeNs offset_ns);

/// Throws InputError where two times in a row are farther apart than a recording holds. `whose`:
/// "em0: its samples".
void RefuseLeaps(const std::string& whose, const std::vector<TimeNs>& times);

/// Exact, in seconds: "12.3".
std::string SecondsText(TimeNs t_ns);

struct TimeUnitGuess {
  std::string unit;  ///< empty: nothing tells
  std::string why;
};
/// By the first times of a table.
TimeUnitGuess GuessTimeUnit(const std::vector<std::string>& times);

}  // namespace flextip::exchange
