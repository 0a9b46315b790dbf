// What calibrate stereo writes.
#pragma once

#include <string>

#include "apps/common/output.h"
#include "calibration/verdict/camera.h"

namespace flextip {

/// cam0/sensor.yaml, cam1/sensor.yaml, calibration.yaml, the rectification in OpenCV's and ROS's
/// form, residuals.csv, tables of uncertainty, figures.json, summary.json, report.html; and the
/// folder in its place. `T_RC0`: camera 0 in R.
void WriteStereoResults(OutputFolder& output, const JudgedStereo& judged, const std::string& board,
                        const Pose& T_RC0);

}  // namespace flextip
