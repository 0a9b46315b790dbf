// The two poses under which a square is seen nearly alike.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "core/pose.h"
#include "vision/camera_model.h"

namespace flextip {

/// Returns the poses T_CG of a square of side `size_m` (m) that explain its corners (order of
/// TagDetection): two, one or none, the better first. Method: infinitesimal plane-based pose
/// estimation (Collins and Bartoli 2014).
std::vector<Pose> PlanarPoses(const CameraModel& camera, double size_m,
                              const std::array<Eigen::Vector2d, 4>& corners_px);

}  // namespace flextip
