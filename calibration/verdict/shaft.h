// Judges the calibrations of gages and stiffness.
#pragma once

#include <string>
#include <vector>

#include "calibration/shaft/stiffness_calibration.h"
#include "calibration/shaft/strain_calibration.h"
#include "calibration/verdict/verdict.h"

namespace flextip {

CalibrationVerdict JudgeStrain(const StrainCalibration& result);

/// Returns why the stiffness found is not the whole truth.
std::vector<std::string> StiffnessDoubts(const StiffnessCalibration& result);

CalibrationVerdict JudgeStiffness(const StiffnessCalibration& result);

}  // namespace flextip
