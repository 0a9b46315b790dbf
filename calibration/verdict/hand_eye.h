// Judges where camera and board, or the tag collar, were found to be.
#pragma once

#include "calibration/hand_eye/hand_eye.h"
#include "calibration/verdict/verdict.h"

namespace flextip {

/// Judges a usable result. `found`: the same as HandEyeCalibration gives it, whose names are used.
CalibrationVerdict JudgeHandEye(const HandEyeResult& result, const Calibration& found);

}  // namespace flextip
