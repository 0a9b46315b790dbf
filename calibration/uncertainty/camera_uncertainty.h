// How well a calibrated camera knows where a point is seen: both maps, and which view to add next.
#pragma once

#include <optional>
#include <vector>

#include "calibration/uncertainty/next_view.h"
#include "calibration/uncertainty/projection_uncertainty.h"

namespace flextip {

/// Over the picture, at the depth the boards were at and at infinity.
struct CameraUncertainty {
  UncertaintyMap near, far;
  std::vector<NextView> next;  ///< three, the best first; empty where none was looked for
};

/// Returns nothing where the views do not determine the camera. `x_B`: the board's corners (m);
/// without them no next view is looked for.
std::optional<CameraUncertainty> FindUncertainty(const CameraSolution& solution,
                                                 const std::vector<Eigen::Vector3d>& x_B);
/// Returns the same for camera `eye`, 0 or 1, of two calibrated together; without next views.
std::optional<CameraUncertainty> FindUncertainty(const StereoSolution& solution, int eye);

}  // namespace flextip
