// The verdicts of calibrate strain and calibrate stiffness.
#pragma once

#include "apps/calibrate/verdict.h"
#include "calibration/shaft/stiffness_calibration.h"
#include "calibration/shaft/strain_calibration.h"

namespace flextip {

CalibrationVerdict StrainVerdict(const StrainCalibration& result);
/// Why the stiffness found is not the whole truth.
std::vector<std::string> StiffnessDoubts(const StiffnessCalibration& result);

CalibrationVerdict StiffnessVerdict(const StiffnessCalibration& result);

}  // namespace flextip
