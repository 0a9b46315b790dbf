// Results as entries of calibration.yaml, with their covariance in the order of
// Calibration::CoordinateNames. Those of hand-eye, strain and stiffness come with their results.
#pragma once

#include <string>

#include "calibration/camera/camera_calibration.h"
#include "calibration/em/em_calibration.h"
#include "calibration/stereo/stereo_calibration.h"
#include "calibration/tip/pivot.h"
#include "recording/calibrations/file.h"

namespace flextip {

/// `cam0.intrinsics` and `cam0.distortion_coefficients`.
Calibration CameraEntries(const CameraCalibrationResult& result);
/// `cam1.T_C0C1` and both cameras' lenses.
Calibration StereoEntries(const StereoResult& result);
/// `tip_name` ("tip.p_WE", "tip.p_SE" or "tags0.p_E") and `pivot.p_R`.
Calibration TipEntries(const PivotResult& result, const std::string& tip_name);
/// `em0.T_RF`, and `em0.distance_from_tip_m` and `em0.field` where they were found.
Calibration EmEntries(const EmResult& result);

}  // namespace flextip
