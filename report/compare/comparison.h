// Results of several runs of one command, side by side.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "report/figure.h"

namespace flextip::report {

/// A number of summary.json in every run; nested ones by their path ("rod-track: rms_deviation_m").
struct ComparedNumber {
  enum class Better : std::uint8_t { kNeither, kSmaller, kLarger };

  std::string key;                            ///< of summary.json, behind the path
  std::string group;                          ///< the path before it, "rod-track"; may be empty
  std::vector<std::optional<double>> values;  ///< one a run
  Better better = Better::kNeither;

  /// Returns the run with the best value; nothing where there is no better, fewer than two values,
  /// or all are equal.
  std::optional<std::size_t> Best() const;
};

struct Comparison {
  std::string command = {};  ///< of all runs
  /// Of the runs: their folders', with as much of the path as tells them apart.
  std::vector<std::string> names = {};
  std::vector<std::filesystem::path> folders = {};
  std::vector<std::string> answers = {};  ///< of the runs, each in a sentence; empty where none is
  std::vector<ComparedNumber> numbers = {};
  /// The best run by the command's main figure, in a sentence; the answers where they differ in
  /// words.
  std::string says = {};
  std::vector<Figure> figures = {};  ///< the main figures as bars, the runs' curves over time
};

/// Compares at least two result folders. Throws InputError where a folder is no result, and where
/// they are results of different commands.
Comparison CompareResults(const std::vector<std::filesystem::path>& folders);

}  // namespace flextip::report
