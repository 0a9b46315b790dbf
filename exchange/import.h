// Other people's data as a recording.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "exchange/describe.h"
#include "exchange/import_log.h"
#include "exchange/import_plan.h"
#include "recording/recording.h"

namespace flextip::exchange {

struct Imported {
  Recording recording;
  ImportPlan plan;  ///< complete: the same import again needs nothing else
  ImportLog log;
  std::map<std::string, long> skipped;  ///< rows left out of each stream
  std::vector<StreamLine> others;       ///< streams that are written, and no part of `recording`
  /// Each writes something into the recording's folder: a video, pictures, joints.
  std::vector<std::function<void(const std::filesystem::path&)>> writers;
};

/// Reads what `plan` tells. Throws InputError with file and line for what cannot be used, and
/// NotTold for all that nothing tells and no assumption may stand for.
Imported Import(ImportPlan plan);

/// Writes the recording, its videos and pictures, and import.yaml into `folder`. Throws WorkError
/// where the disk refuses.
void WriteImported(const std::filesystem::path& folder, const Imported& imported);

}  // namespace flextip::exchange
