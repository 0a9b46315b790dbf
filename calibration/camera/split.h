// Cross-validation: the lens from half of the views beside the lens from the other half.
#pragma once

#include <optional>

#include "calibration/camera/solution.h"

namespace flextip {

/// The distance between the places where two lenses put the same points of the world, over the part
/// of the picture where corners were seen. It holds at the median distance of the boards, after the
/// best rigid motion of the first camera against the second: a lens's part that looks like a pose
/// is no difference.
struct ProjectionDifference {
  double rms_px = 0.0, max_px = 0.0;
};

/// Returns the difference between the lenses of views 0, 2, 4... and 1, 3, 5... Empty with less
/// than six views, and where a half does not determine its lens.
std::optional<ProjectionDifference> SplitViews(const CameraSolution& solution);

/// Returns the difference between two cameras over the rectangle `low_px` to `high_px` at
/// `distance_m`. Empty where no motion brings the two together.
std::optional<ProjectionDifference> DifferenceOf(const CameraCalibration& a,
                                                 const CameraCalibration& b,
                                                 const Eigen::Vector2d& low_px,
                                                 const Eigen::Vector2d& high_px, double distance_m);

}  // namespace flextip
