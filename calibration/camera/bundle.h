// Bundle adjustment: lens, board warp and board poses that put the corners where they were seen.
#pragma once

#include <vector>

#include "calibration/camera/solution.h"

namespace flextip {

struct BundleOptions {
  bool fix_intrinsics = false;  ///< only poses (and the warp) move
  std::vector<int> fixed = {};  ///< places in fu, fv, cu, cv, coefficients... that are held
  bool estimate_warp = false;
  /// The corners' places on the board move too, by `solution.shape.sd_m` (above 0) and
  /// `solution.noise_px`, as it is at the start, against each other. Otherwise the shape is held.
  bool estimate_shape = false;
  /// Corners count by Cauchy's loss of this scale; 0: least squares.
  double cauchy_px = 0.0;
  int max_iterations = 60;
  double tolerance = 1e-8;  ///< ends where the cost falls by less than this part
};

/// Moves `solution` to the minimum near it over the corners that are used, and fills in what
/// follows from it: residuals of all corners, noise, and (with `fix_intrinsics` too) the normal
/// matrix. False where there is none to be found: a corner behind the camera, no descent, or
/// numbers that are not finite; `solution` is then as it was.
bool AdjustBundle(CameraSolution& solution, const BundleOptions& options = {});

}  // namespace flextip
