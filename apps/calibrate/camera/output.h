// What calibrate camera writes.
#pragma once

#include "apps/common/output.h"
#include "calibration/verdict/camera.h"

namespace flextip {

/// cam0/sensor.yaml, calibration.yaml, residuals.csv, figures, overlay pictures, summary.json,
/// report.html; and the folder in its place.
void WriteCameraResults(OutputFolder& output, const CornersFile& corners,
                        const JudgedCamera& judged);

}  // namespace flextip
