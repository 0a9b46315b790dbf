// What commands that work on a whole recording are given, and how they read it.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "apps/common/command_paths.h"
#include "apps/common/input/calibration_input.h"
#include "plausibility/command_use.h"
#include "recording/calibrations/calibrated_recording.h"

namespace flextip {

struct RecordingInput {
  std::filesystem::path recording, out;
  std::filesystem::path tracked;  ///< a result of flextip track; empty: the recording's own tips
  CalibrationFiles calibrations;
  bool no_check = false;
  bool silent = false;  ///< what the check finds is not printed: another process says it

  /// Everything that is read, for OutputFolder.
  std::vector<std::filesystem::path> Files() const;
  /// The paths of the input, for commands to copy.
  CommandPaths Paths() const;
};

struct InputRead : CalibratedRecording {
  /// Returns the streams of which estimation and diagnosis use nothing: "cam0, command0".
  std::string NotUsed() const;
  std::vector<plausibility::Finding> findings;  ///< that do not stop the command
};

/// RECORDING, --output, --tracked, --calibration and --no-check. `input` must outlive the parsing.
void AddRecordingInput(CLI::App& command, RecordingInput& input);

/// The recording without a look at its frames, vision0 replaced by the tracked one where that was
/// asked for, and with the calibrations in it; tracked tips are taken as they are. Throws
/// InputError.
InputRead ReadInput(const RecordingInput& input);
/// The same, checked for what the command does with it (CheckInput).
InputRead ReadInput(const RecordingInput& input, const plausibility::CommandUse& use, bool quiet);

}  // namespace flextip
