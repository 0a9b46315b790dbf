// Where a board's corners truly are: prints are scaled and sheets are bent.
#pragma once

#include <optional>
#include <utility>

#include "calibration/camera/camera_solution.h"

namespace flextip {

/// Adjusts lens, warp and poses together with every corner's place on the board (Strobl and
/// Hirzinger, ICCV Workshops 2008, free the corners in the same way), each coordinate held to the
/// description by `sd_m`, which also keeps the board's size. Without `sd_m` it is the scatter that
/// the views themselves show (empirical Bayes, by expectation and maximisation). Starts from
/// `solution.shape`. False where an adjustment fails; `solution` is then as it was.
bool EstimateBoardShape(CameraSolution& solution, std::optional<double> sd_m = {});

/// The root of the mean squared length of the offsets (m), and the longest.
std::pair<double, double> SizeOf(const BoardShape& shape);

}  // namespace flextip
