#include "tests/vision/scope_scene.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/rotation.h"
#include "tests/simulation/render_test_scene.h"
#include "tests/vision/synthetic_tag.h"

namespace flextip {
namespace {

constexpr double kBehindTip_m = 0.015, kDistance_m = 0.1;

}  // namespace

CameraCalibration ScopeCamera() {
  CameraCalibration camera;
  camera.width_px = 320;
  camera.height_px = 240;
  camera.fu_px = 600;
  camera.fv_px = 598;
  camera.cu_px = 161.3;
  camera.cv_px = 118.6;
  camera.distortion_coefficients = {-0.22, 0.08, 0.0006, -0.0004};
  camera.gamma = 2.2;
  camera.T_RC = {ExpRotation({2.0, 0.3, -0.4}), {0.1, -0.05, 0.2}};
  return camera;
}

CameraCalibration SecondScopeCamera() {
  CameraCalibration camera = ScopeCamera();
  const Pose T_C0C1{ExpRotation({0, -0.25, 0}), {0.025, 0, 0.003}};
  camera.T_RC = camera.T_RC * T_C0C1;
  return camera;
}

TagCollar ScopeCollar(double outward_m, int first_id) {
  TagCollar collar = PrismCollar(6, 0.005, 0.0055 + outward_m, -kBehindTip_m);
  for (CollarTag& tag : collar.tags) tag.id += first_id;
  return collar;
}

Pose ScopePose(double lean, double roll, const Eigen::Vector3d& offset_C) {
  const Eigen::Vector3d d_C(-std::cos(lean), 0.2, std::sin(lean)), d = d_C.normalized();
  const Eigen::Vector3d out = (-Eigen::Vector3d::UnitZ() + d.z() * d).normalized();
  Pose T_CE;
  T_CE.R << d, out, d.cross(out);
  T_CE.R = T_CE.R * ExpRotation({roll, 0, 0});
  T_CE.p = Eigen::Vector3d(0, 0, kDistance_m) + offset_C + kBehindTip_m * d;
  return ScopeCamera().T_RC * T_CE;
}

simulation::LaparoscopeOptions ScopeOptions(const CameraCalibration& camera) {
  simulation::LaparoscopeOptions options;
  options.tissue.point_R = camera.T_RC * Eigen::Vector3d(0, 0, 0.16);
  options.tissue.normal_R = camera.T_RC.R * Eigen::Vector3d(0.2, -0.3, -1);
  options.exposure_distance_m = 0.1;
  options.exposure = 0.5;
  options.grey = true;
  options.seed = 5;
  return options;
}

simulation::ShaftCurve ScopeShaft(const Pose& T_RE) {
  return render_test::ArcShaft(T_RE, 0.3, 0.8, 0.005);
}

simulation::LinearImage LightThroughLens(const CameraCalibration& camera, const TagCollar& collar,
                                         const Pose& T_RE, double blur_px) {
  simulation::LaparoscopeOptions options = ScopeOptions(camera);
  options.blur_sigma_px = blur_px;
  options.parts_per_px = 3;
  return simulation::Laparoscope(camera, collar, options).RenderLight(ScopeShaft(T_RE), 0);
}

Image Film(const simulation::LinearImage& light, double gamma, unsigned seed) {
  constexpr double kFullWell = 15000, kRead = 15;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Image image(light.width_px, light.height_px, 1);
  for (std::size_t i = 0; i < image.data.size(); ++i) {
    const double electrons = kFullWell * std::max(0.0f, light.data[i]);
    const double signal =
        (electrons + std::sqrt(electrons + kRead * kRead) * normal(random)) / kFullWell;
    image.data[i] = static_cast<std::uint8_t>(
        std::lround(255 * std::pow(std::clamp(signal, 0.0, 1.0), 1 / gamma)));
  }
  return image;
}

TagCollar OnlyTag(const TagCollar& collar, int id) {
  TagCollar one = collar;
  std::erase_if(one.tags, [id](const CollarTag& tag) { return tag.id != id; });
  return one;
}

}  // namespace flextip
