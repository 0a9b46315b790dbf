// Pictures of a camera's calibration.
#pragma once

#include <filesystem>

#include "calibration/boards/corners_file.h"
#include "calibration/camera/camera_calibration.h"

namespace flextip {

inline constexpr double kResidualsLonger = 30.0;  ///< residuals are drawn so many times as long

/// The residual as drawn: longer, but at most a fifth of the picture's width.
Eigen::Vector2d DrawnResidual(const Eigen::Vector2d& residual_px, int width_px);

/// FOLDER/overlay/*.png: each view, where its file is still there, with corners (green), outliers
/// (red) and residuals.
void DrawCameraPictures(const std::filesystem::path& folder, const CornersFile& corners,
                        const CameraCalibrationResult& result);

}  // namespace flextip
