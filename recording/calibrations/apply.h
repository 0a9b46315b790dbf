// Puts what a calibration found in the place of what a recording says (docs/formats.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "recording/calibrations/file.h"
#include "recording/recording.h"

namespace flextip {

struct AppliedCalibration {
  std::vector<std::string> used;      ///< names that changed the recording
  std::vector<std::string> not_used;  ///< of the set-up alone (board, pivot)
  std::vector<std::string> warnings;  ///< parts of the recording that stay as before
};

/// Replaces values of `recording` by those of `calibration`, `em0.field` last. Streams that depend
/// on a value change with it: vision0 with `cam0.T_RC` and `cam0.time_offset_s`, cam1 with cam0
/// where it has no values of its own. `cam1.T_C0C1` places cam1 by the new cam0. `file` is for
/// messages. Throws InputError naming file and name for an unknown name, for a sensor that the
/// recording lacks, for values without meaning, and for a camera on the wrist (`T_WC`). The
/// recording is half changed then.
AppliedCalibration ApplyCalibration(const std::filesystem::path& file,
                                    const Calibration& calibration, Recording& recording);

/// A calibration file and the names of it that changed the recording.
struct UsedCalibration {
  std::filesystem::path file;
  Calibration calibration;
  std::vector<std::string> names;
};

/// Reads `files` and applies them in their order. Appends to `warnings`, also for a file without
/// anything for a recording. Throws InputError as ReadCalibration and ApplyCalibration.
std::vector<UsedCalibration> ApplyCalibrations(const std::vector<std::filesystem::path>& files,
                                               Recording& recording,
                                               std::vector<std::string>& warnings);

/// States in `vision` how well its camera's `T_RC` is known by `calibration` (turn, and shift where
/// the tips are); nothing where that was not found with a covariance. For tips that were already
/// found with it.
void StateRegistrationNoise(const Calibration& calibration, VisionStream& vision);

}  // namespace flextip
