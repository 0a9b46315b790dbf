// What `calibrate camera` and `calibrate stereo` may be asked of lens and board.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "calibration/camera/camera_calibration.h"

namespace flextip {

struct LensOptions {
  std::string board;
  std::string distortion = "auto", warp = "auto";
  int terms = 5;
  std::optional<double> board_sd_m;

  CameraCalibrationOptions Calibration() const;
};

/// Adds --board, --distortion, --terms, --warp and --board-error.
void AddLensOptions(CLI::App& command, LensOptions& options);

}  // namespace flextip
