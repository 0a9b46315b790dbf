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

/// Returns the number behind `key` in the unit people read: metres as mm, shares as %.
std::string SpokenValue(const std::string& key, double value);

}  // namespace flextip::report
