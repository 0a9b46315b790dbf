// Other people's data as a recording.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "exchange/import_log.h"
#include "exchange/import_plan.h"
#include "recording/recording.h"

namespace flextip::exchange {

struct Imported {
  Recording recording;
  ImportPlan plan;  ///< complete: the same import again needs nothing else
  ImportLog log;
  std::map<std::string, long> skipped;  ///< rows left out of each stream
  /// Files that belong into the recording: from, and the place in its folder.
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> files;
};

/// Reads what `plan` tells. Throws InputError with file and line for what cannot be used, and
/// NotTold for what nothing tells and no assumption may stand for.
Imported Import(ImportPlan plan);

/// Writes the recording, its files (a copy, or a link where the plan says so) and import.yaml into
/// `folder`. Throws WorkError where the disk refuses.
void WriteImported(const std::filesystem::path& folder, const Imported& imported);

/// A stream as a recording has it.
struct StreamLine {
  std::string name;
  std::size_t samples = 0;
  TimeNs first_ns = 0, last_ns = 0;
  double rate_hz = 0.0;
  std::string first_value;

  double Seconds() const { return 1e-9 * static_cast<double>(last_ns - first_ns); }
};
/// Of every stream with samples.
std::vector<StreamLine> DescribeStreams(const Recording& recording);

}  // namespace flextip::exchange
