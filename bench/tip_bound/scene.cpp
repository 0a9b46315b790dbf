#include "bench/tip_bound/scene.h"

#include <cmath>
#include <numbers>
#include <random>

#include "core/rotation.h"

namespace flextip::bench {

using Eigen::Vector3d;

CameraCalibration BoundCamera() {
  CameraCalibration camera;
  camera.width_px = 1280;
  camera.height_px = 720;
  camera.fu_px = camera.fv_px = 950;
  camera.cu_px = 646.5;
  camera.cv_px = 355.5;
  camera.distortion_coefficients = {-0.22, 0.08, 0.0006, -0.0004};
  camera.gamma = 2.2;
  return camera;
}

TagCollar BoundCollar(double size_m) {
  TagCollar collar;
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3;
    const Vector3d out(0, std::cos(angle), std::sin(angle));
    CollarTag tag{i, size_m, {}};
    tag.T_EG.R.col(0) = Vector3d::UnitX();
    tag.T_EG.R.col(2) = -out;
    tag.T_EG.R.col(1) = tag.T_EG.R.col(2).cross(tag.T_EG.R.col(0));
    tag.T_EG.p = size_m * out + Vector3d(-0.03, 0, 0);
    collar.tags.push_back(tag);
  }
  return collar;
}

TubeShape BoundTube(const TagCollar& collar) {
  const double size_m = collar.tags.front().size_m;
  TubeShape tube;
  tube.diameter_m = 0.005;
  tube.collar = TubeShape::Collar{-0.03 - 0.7 * size_m, -0.03 + 0.7 * size_m, 1.3 * size_m};
  return tube;
}

simulation::LaparoscopeOptions BoundScope(double blur_px) {
  simulation::LaparoscopeOptions options;
  options.tissue.point_R = {0, 0, 0.17};
  options.tissue.normal_R = {0.2, -0.3, -1};
  options.grey = true;
  options.blur_sigma_px = blur_px;
  options.parts_per_px = 3;
  options.seed = 3;
  return options;
}

simulation::ShaftCurve CurveOf(const BoundScene& scene, const TubeShape& tube) {
  simulation::ShaftCurve curve;
  curve.diameter_m = tube.diameter_m;
  curve.T_RE = scene.T_CE;
  constexpr int kPieces = 150;
  for (int i = kPieces; i >= 0; --i) {
    curve.points.push_back(scene.T_CE * TubeCentre(scene.bend, 0.2 * i / kPieces).x_E);
  }
  return curve;
}

std::vector<BoundScene> DrawScenes(int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::normal_distribution<double> normal;
  std::vector<BoundScene> scenes(count);
  for (BoundScene& scene : scenes) {
    const double turn = -0.2 + 0.5 * unit(random), tilt = 0.6 * unit(random);
    scene.T_CE.R = ExpRotation({0, 0, turn}) * ExpRotation({0, std::numbers::pi - tilt, 0}) *
                   ExpRotation({std::numbers::pi * unit(random), 0, 0});
    scene.T_CE.p = {-0.02 + 0.012 * unit(random), 0.01 * unit(random), 0.11 + 0.03 * unit(random)};
    scene.bend = {6 * normal(random), 6 * normal(random)};
  }
  return scenes;
}

}  // namespace flextip::bench
