// A recording as the commands that work on it as a whole take it: with calibrations, and with the
// tips of a tracker's run where there is one.
#pragma once

#include <filesystem>
#include <vector>

#include "recording/calibrations/apply.h"
#include "recording/recording_reader.h"

namespace flextip {

struct CalibratedRecording : ReadResult {
  std::vector<UsedCalibration> calibrations;
};

struct CalibratedReadOptions {
  std::vector<std::filesystem::path> calibrations;  ///< applied in this order
  std::filesystem::path tracked;  ///< a result of flextip track in place of vision0; empty: none
  bool check_frames = false;      ///< looks whether the frames are there
};

/// Reads `folder` and applies the calibrations. Tracked tips are taken as they are; of the
/// calibrations only the registration's noise counts for them. Throws InputError with file and
/// line.
CalibratedRecording ReadCalibrated(const std::filesystem::path& folder,
                                   const CalibratedReadOptions& options);

}  // namespace flextip
