// A camera on the command line: a file of any program, or a focal length with a resolution.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "core/camera.h"

namespace flextip {

struct CameraOption {
  std::filesystem::path file;
  double focal_px = 950.0;
  std::vector<int> resolution_px = {1280, 720};
};

/// Adds --camera, --focal and --resolution. `option` must outlive the parsing.
void AddCameraOption(CLI::App& command, CameraOption& option);

/// Returns the camera. Throws InputError where the file cannot be read.
CameraCalibration ReadCamera(const CameraOption& option);

}  // namespace flextip
