// Reads a recording's folder and rejects data that cannot be trusted.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace flextip {

/// A recording, and the data that had to be skipped to read it.
struct ReadResult {
  Recording recording;
  std::vector<std::string> warnings;  ///< one line each: a torn last line, a dropped frame, ...
  long torn_lines = 0;                ///< skipped, of a crashed recorder
  long dropped_frames = 0;            ///< rows without a file name, and gaps in the frames' time
};

struct ReadOptions {
  bool check_frames = true;  ///< that the frames of cam0 and cam1 exist and have the stated size
};

/// Reads every stream present in `folder` (docs/formats.md). Throws InputError with file and line
/// for missing or extra columns, NaN or infinite values, time running backwards, quaternions off
/// unit length by more than 1e-3, frames missing or of another size, unknown versions.
ReadResult ReadRecording(const std::filesystem::path& folder, const ReadOptions& options = {});

}  // namespace flextip
