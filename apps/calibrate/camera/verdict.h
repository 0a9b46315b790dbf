// The verdicts of calibrate camera and calibrate stereo.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/calibrate/verdict.h"
#include "calibration/stereo/stereo_calibration.h"

namespace flextip {

/// `summary`: as written, with projection_uncertainty and split_views_rms_px where they are known.
CalibrationVerdict CameraVerdict(const CameraCalibrationResult& result,
                                 const nlohmann::json& summary);
CalibrationVerdict StereoVerdict(const StereoResult& result, const nlohmann::json& summary);

}  // namespace flextip
