// One file and one function for each format of other programs. A new format is a function that
// takes the plan, completes it with what it found, and adds streams to the recording.
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

/// What a format makes of its files.
struct Streams {
  Recording recording;                  ///< streams only; the settings come later
  std::map<std::string, long> skipped;  ///< rows left out of each stream
  /// A file that belongs into the recording: from, and the place in its folder.
  std::vector<std::pair<std::filesystem::path, std::filesystem::path>> files;
};

/// Tables: every stream of plan.streams, and those found in plan.files.
void ReadCsv(ImportPlan& plan, Streams& streams, ImportLog& log);

/// plan.video: cam0 with its frames' times, and tags0.
void ReadVideoFile(ImportPlan& plan, Streams& streams, ImportLog& log);

}  // namespace flextip::exchange
