// Figures of all corners over the picture's plane.
#pragma once

#include "calibration/boards/corners_file.h"
#include "calibration/camera/camera_calibration.h"
#include "report/figure.h"

namespace flextip {

/// Corners and outliers of all views with their residuals.
report::Figure ResidualsFigure(const CornersFile& corners, const CameraSolution& solution);

/// How many corners each part of the picture has seen.
report::Figure CoverageFigure(const CornersFile& corners, const CameraSolution& solution);

}  // namespace flextip
