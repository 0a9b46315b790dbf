// The two poses under which a square is seen nearly alike.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "core/pose.h"
#include "vision/camera_model.h"

namespace flextip {

/// T_CG of a square of side `size_m` from its corners (order of TagDetection) by infinitesimal
/// plane-based pose estimation: two, one or no solutions, the better first.
std::vector<Pose> PlanarPoses(const CameraModel& camera, double size_m,
                              const std::array<Eigen::Vector2d, 4>& corners_px);

}  // namespace flextip
