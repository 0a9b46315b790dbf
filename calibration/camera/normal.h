// What follows from where a camera's solution is: residuals, normal matrix and noise. Private to
// this folder.
#pragma once

#include "calibration/camera/bundle.h"
#include "calibration/camera/solution.h"

namespace flextip {

/// Fills in residuals of all corners, `normal_matrix`, `noise_px` and, with `estimate_shape`,
/// `shape.scatter_m`. False where a corner cannot be seen or a number is not finite.
bool EvaluateSolution(const BundleOptions& options, CameraSolution& solution);

}  // namespace flextip
