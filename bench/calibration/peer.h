// Calibrations of one corner set, to be compared.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/calibration/corners.h"
#include "calibration/camera/choice.h"
#include "calibration/camera/solution.h"

namespace flextip::bench {

struct CalibrationAnswer {
  CameraCalibration camera;
  BoardWarp warp;
  BoardShape shape;
  std::vector<double> sd;  ///< deviations of fu, fv, cu, cv (px) and the peer's coefficients
  double rms_px = 0;       ///< error of the corners used, per distance
  int outliers = 0;
  double seconds = 0;                      ///< processor time, all threads
  std::optional<CameraSolution> solution;  ///< this program's
};

/// OpenCV's calibrateCamera as its example calls it, from its own start, with 4, 5, 8 or 12 terms.
CalibrationAnswer CalibrateByOpenCv(const CornerSet& set, int terms);

/// CalibrateCamera; without `lens` the one that held-out views choose. `board_sd_m` as in
/// CameraCalibrationOptions: 0 is a board as described.
CalibrationAnswer CalibrateByFlextip(const CornerSet& set, const std::optional<LensModel>& lens,
                                     std::optional<double> board_sd_m = {});

/// Root of the mean squared distance of all corners of `set`, each view's pose fitted to them.
double FittedPosesRms(const CalibrationAnswer& answer, const CornerSet& set);

}  // namespace flextip::bench
