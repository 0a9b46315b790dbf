// Names and numbers of summary.json in a robot engineer's words.
#pragma once

#include <string>

namespace flextip::report {

/// Returns the label of a key: "tip_share_inside_95" -> "tip errors inside their 95 % ellipsoid". A
/// key without a label of its own loses its unit: "final_error_m" -> "final error". `command` (of
/// summary.json) chooses where a key has a meaning for each.
std::string Label(const std::string& key, const std::string& command = "");

/// Whether `a` matters more than `b` among the numbers of a command; keys without a label of their
/// own matter least.
bool IsBefore(const std::string& a, const std::string& b, const std::string& command);

/// The unit people read a key's numbers in, and the factor to it: "_m" is "mm" and 1000. No unit
/// and 1 where the key has none.
struct SpokenUnit {
  std::string unit;
  double factor = 1.0;
};
SpokenUnit UnitOf(const std::string& key);

/// Returns the number behind `key` in the unit people read: metres as mm, shares as %.
std::string SpokenValue(const std::string& key, double value);

}  // namespace flextip::report
