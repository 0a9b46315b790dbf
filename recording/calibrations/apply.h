// What a calibration found, put in the place of what a recording says (docs/formats.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recording/calibrations/file.h"
#include "recording/recording.h"

namespace flextip {

struct AppliedCalibration {
  std::vector<std::string> used;  ///< names that changed the recording
  std::vector<std::string>
      not_used;  ///< of the set-up alone (board, pivot): no part of a recording
  std::vector<std::string> em_field;  ///< `em0.field` and its like: for EmField (calibration/)
  std::vector<std::string> warnings;  ///< what in the recording still is as before
};

/// Streams that speak of what was calibrated go along: vision0 with `cam0.T_RC` and
/// `cam0.time_offset_s`, cam1 with cam0 where it has no values of its own; `cam1.T_C0C1` places
/// cam1 by cam0 as it then is. `file` is for messages. Throws InputError naming file and name for a
/// name that is not known, for one of a sensor that the recording has not, for values that make no
/// sense, and for a camera on the wrist (`T_WC`). The recording is then as good as lost.
AppliedCalibration ApplyCalibration(const std::filesystem::path& file,
                                    const Calibration& calibration, Recording& recording);

/// States in `vision` how well its camera's `T_RC` is known by `calibration` (turn, and shift where
/// the tips are); nothing where that was not found with a covariance. For tips that were already
/// found with it.
void StateRegistrationNoise(const Calibration& calibration, VisionStream& vision);

}  // namespace flextip
