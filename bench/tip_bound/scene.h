// The scenes whose tips are bounded: a bent shaft with its tag collar before tissue.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"
#include "core/tag_collar.h"
#include "simulation/plant/shaft_curve.h"
#include "simulation/render/laparoscope.h"
#include "vision/outline/tube_geometry.h"

namespace flextip::bench {

struct BoundScene {
  Pose T_CE;
  Eigen::Vector2d bend = Eigen::Vector2d::Zero();  ///< 1/m^2, see TubeCentre
};

/// 1280x720, f = 950 px, lens distortion, at the origin of R, gamma 2.2.
CameraCalibration BoundCamera();
/// Six tags of `size_m` around the shaft, their middles 30 mm behind E.
TagCollar BoundCollar(double size_m);
/// The shaft without what the collar may cover.
TubeShape BoundTube(const TagCollar& collar);
/// Grey; tissue 0.17 m away.
simulation::LaparoscopeOptions BoundScope(double blur_px);

simulation::ShaftCurve CurveOf(const BoundScene& scene, const TubeShape& tube);

/// The tip near the picture's middle, 80 to 140 mm away, the shaft up to 35 degrees out of the
/// picture's plane, any roll.
std::vector<BoundScene> DrawScenes(int count, std::uint64_t seed);

}  // namespace flextip::bench
