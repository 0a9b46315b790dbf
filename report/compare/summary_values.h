// The values of a summary.json that stand for themselves, to be put beside those of other runs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace flextip::report {

struct SummaryValue {
  std::string group;             ///< the path before the key, "rod-track"; may be empty
  std::string key;               ///< of summary.json, behind the path
  std::string text;              ///< the value: exact where it is a number
  std::optional<double> number;  ///< where it is one

  /// Returns "rod-track/rms_deviation_m".
  std::string Path() const { return group.empty() ? key : group + "/" + key; }
};

/// Returns the numbers, words and lists of words of FOLDER/summary.json and of the objects in it.
/// Its verdict comes as `grade` and `answer`. What tells of the run is left out: command, version,
/// date, inputs, warnings, findings. Throws InputError where the folder is no result.
std::vector<SummaryValue> ValuesOf(const std::filesystem::path& folder);

}  // namespace flextip::report
