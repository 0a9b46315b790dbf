// How well a stereo calibration predicts pairs of pictures that it has not seen.
#pragma once

#include <optional>

#include "calibration/stereo/stereo_calibration.h"

namespace flextip {

/// Pairs that both eyes saw are left out, a fold of them at a time. Empty where a fold cannot be
/// solved.
std::optional<StereoHeldOut> LeavePairsOut(const StereoSolution& solution, int folds);

/// Root of the mean squared difference of rows after rectification, over corners that both eyes
/// saw.
double EpipolarRmsPx(const StereoSolution& solution);

}  // namespace flextip
