// Bundle adjustment of two cameras fixed to each other.
#pragma once

#include "calibration/stereo/solution.h"

namespace flextip {

struct StereoBundleOptions {
  bool fix_cameras = false;  ///< only the board's poses move: lenses, T_C0C1 and warp stay
  bool estimate_warp = false;
  bool estimate_shape = false;  ///< as in BundleOptions
  double cauchy_px = 0.0;       ///< corners count by Cauchy's loss of this scale; 0: least squares
  int max_iterations = 60;
};

/// Moves `solution` to the minimum near it over the corners that are used and fills in residuals of
/// all corners, noise and normal matrix. False, and `solution` as it was, where none is found.
bool AdjustStereo(StereoSolution& solution, const StereoBundleOptions& options = {});

}  // namespace flextip
