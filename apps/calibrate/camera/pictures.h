// Pictures of a camera's calibration.
#pragma once

#include <filesystem>

#include "calibration/boards/corners_file.h"
#include "calibration/camera/camera_calibration.h"

namespace flextip {

/// FOLDER/overlay/*.png: each view, where its file is still there, with corners (green), outliers
/// (red) and residuals, 30 times as long as they are. FOLDER/residuals.png: those of all views over
/// the picture's plane. FOLDER/coverage.png: how many corners each part of the picture has seen.
void DrawCameraPictures(const std::filesystem::path& folder, const CornersFile& corners,
                        const CameraCalibrationResult& result);

}  // namespace flextip
