// The verdicts of calibrate strain and calibrate stiffness.
#pragma once

#include "apps/calibrate/calibrate_verdict.h"
#include "calibration/shaft/stiffness_calibration.h"
#include "calibration/shaft/strain_calibration.h"

namespace flextip {

CalibrationVerdict StrainVerdict(const StrainCalibration& result);
CalibrationVerdict StiffnessVerdict(const StiffnessCalibration& result);

}  // namespace flextip
