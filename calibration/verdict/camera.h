// Calibrations of one camera and of two, judged: from corners to the verdict of the page.
#pragma once

#include <array>
#include <optional>

#include "calibration/boards/corners_file.h"
#include "calibration/camera/camera_calibration.h"
#include "calibration/camera/split.h"
#include "calibration/stereo/stereo_calibration.h"
#include "calibration/uncertainty/camera_uncertainty.h"
#include "calibration/verdict/verdict.h"

namespace flextip {

struct JudgedCamera {
  CameraCalibrationResult result;  ///< the rest is empty where it is not usable
  std::optional<ProjectionDifference> split;
  std::optional<CameraUncertainty> uncertainty;
  CalibrationVerdict verdict;
};

/// Calibrates one camera from the corners of its views, and judges the result. Throws InputError
/// for a board or size that is none.
JudgedCamera CalibrateAndJudge(const CornersFile& corners,
                               const CameraCalibrationOptions& options = {});

struct JudgedStereo {
  StereoResult result;  ///< the rest is empty where it is not usable
  std::array<std::optional<CameraUncertainty>, 2> uncertainty;
  CalibrationVerdict verdict;
};

/// Calibrates and judges two cameras, left and right; their views are pairs in their order.
JudgedStereo CalibrateAndJudge(const std::array<CornersFile, 2>& eyes,
                               const StereoOptions& options = {});

/// Judges a usable result. Without `uncertainty` or `split` nothing is said of them.
CalibrationVerdict JudgeCamera(const CameraCalibrationResult& result,
                               const std::optional<CameraUncertainty>& uncertainty,
                               const std::optional<ProjectionDifference>& split);
CalibrationVerdict JudgeStereo(const StereoResult& result,
                               const std::array<std::optional<CameraUncertainty>, 2>& uncertainty);

}  // namespace flextip
