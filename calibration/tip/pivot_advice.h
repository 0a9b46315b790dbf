// Which further turn would make the tip most certain.
#pragma once

#include <vector>

#include "calibration/tip/pivot.h"

namespace flextip {

/// Of turns by 40 degrees to both sides about B's axes and about the direction turned least. `H`:
/// information of (tip, pivot) so far; `S`: an error's covariance. A quarter as many poses again
/// are supposed, four at least.
PivotAdvice AdvisePivot(const std::vector<PivotPose>& poses, const Matrix6d& H,
                        const Eigen::Matrix3d& S, const Eigen::Matrix3d& turn_axes_B);

}  // namespace flextip
