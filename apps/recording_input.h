// What commands that work on a whole recording are given, and how they read it.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>

#include "recording/recording_reader.h"

namespace flextip {

struct RecordingInput {
  std::filesystem::path recording, out;
  std::filesystem::path tracked;  ///< a result of flextip track; empty: the recording's own tips
};

/// RECORDING, --output and --tracked. `input` must outlive the parsing.
void AddRecordingInput(CLI::App& command, RecordingInput& input);

/// The recording without a look at its frames, vision0 replaced by the tracked one where that was
/// asked for. Throws InputError.
ReadResult ReadInput(const RecordingInput& input);

}  // namespace flextip
