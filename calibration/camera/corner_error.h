// The error of one corner with its derivatives, for Ceres. Private to this folder.
#pragma once

#include <cstddef>
#include <memory>

#include "calibration/camera/solution.h"

namespace ceres {
class CostFunction;
}

namespace flextip {

constexpr int kPoseSize = 6, kWarpSize = 2, kCornerSize = 3;

/// Where `view`'s corner `i` lands less where it was seen (2). Parameters: lens (as in
/// CameraSolution), bulges (2, m), a step (dw, dp) from the view's pose as it is now (6), and, with
/// `by_place`, the corner's offset (3, m, in B); without, the offset is the solution's. Cannot be
/// evaluated where the corner is behind the camera or farther off than a lens function that has run
/// away.
std::unique_ptr<ceres::CostFunction> MakeCornerError(const CameraSolution& solution,
                                                     const SolvedView& view, std::size_t i,
                                                     bool by_place = false);

}  // namespace flextip
