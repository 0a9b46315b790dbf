// One instrument with a hidden cause, a short first motion, and three ways to move on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace flextip::bench {

struct TrialRecord {
  std::string key, effect;
  /// False: the first motion told the cause, or there was no plan, or no cause to be seen at all.
  bool qualifies = false;
  std::string why;  ///< where it does not
  std::vector<std::string> rivals;
  double planned_seconds = 0.0;  ///< as the plan promised
  std::map<std::string, double> load_N;
  /// Seconds of the second motion until the right cause is 95 % certain, by the way to move:
  /// planned, library, random; 40 where 20 s are not enough.
  std::map<std::string, double> seconds;
};

/// Hides an effect of the catalogue, drawn by `seed`, in the scenario of `file`.
TrialRecord RunTrial(const std::filesystem::path& file, std::uint64_t seed);

std::string TrialLine(const TrialRecord& record);
/// All records of a file; none where it is missing.
std::vector<TrialRecord> ReadTrials(const std::filesystem::path& file);
/// Medians and means of the seconds, and how often each way was the quickest.
std::string TrialTable(const std::vector<TrialRecord>& records);

}  // namespace flextip::bench
