#include "bench/vision/scene.h"

#include <cmath>
#include <numbers>

#include "core/rotation.h"
#include "simulation/render/tag_pattern.h"
#include "vision/tags/collar_pose.h"

namespace flextip::bench {

CameraCalibration BenchCamera(int width_px, double gamma) {
  const double scale = width_px / 1280.0;
  CameraCalibration camera;
  camera.width_px = width_px;
  camera.height_px = width_px * 9 / 16;
  camera.fu_px = camera.fv_px = 950 * scale;
  camera.cu_px = (646.5 + 0.5) * scale - 0.5;
  camera.cv_px = (355.5 + 0.5) * scale - 0.5;
  camera.distortion_coefficients = {-0.22, 0.08, 0.0006, -0.0004};
  camera.gamma = gamma;
  Eigen::Quaterniond q_RC(0.4, 0.9, -0.1, 0.15);
  camera.T_RC = Pose::FromQuaternion(q_RC, {0.185, 0.044, 0.084});
  return camera;
}

double RingApothem_m(const std::string& family, double size_m, int sides, double plate) {
  const simulation::TagPattern pattern = simulation::MakeTagPattern(family, 0);
  const double side_m = plate * size_m * pattern.cells / pattern.border_cells;
  return 0.5 * side_m / std::tan(std::numbers::pi / sides);
}

TagCollar RingCollar(const std::string& family, double size_m, int sides, double plate,
                     double behind_tip_m, int first_id) {
  const double apothem_m = RingApothem_m(family, size_m, sides, plate);
  TagCollar collar;
  collar.family = family;
  for (int i = 0; i < sides; ++i) {
    const double angle = i * 2 * std::numbers::pi / sides;
    const Eigen::Vector3d out(0, std::cos(angle), std::sin(angle));
    CollarTag tag{first_id + i, size_m, {}};
    tag.T_EG.R.col(0) = Eigen::Vector3d::UnitX();
    tag.T_EG.R.col(2) = -out;
    tag.T_EG.R.col(1) = tag.T_EG.R.col(2).cross(tag.T_EG.R.col(0));
    tag.T_EG.p = apothem_m * out - behind_tip_m * Eigen::Vector3d::UnitX();
    collar.tags.push_back(tag);
  }
  return collar;
}

simulation::ShaftCurve ArcShaft(const Pose& T_RE, double radius_m, double diameter_m) {
  constexpr double kLength_m = 0.3;
  constexpr int kPieces = 40;
  simulation::ShaftCurve curve;
  curve.diameter_m = diameter_m;
  curve.T_RE = T_RE;
  for (int i = 0; i <= kPieces; ++i) {
    const double angle = kLength_m * (1.0 - i / static_cast<double>(kPieces)) / radius_m;
    curve.points.push_back(
        T_RE * Eigen::Vector3d(-radius_m * std::sin(angle), radius_m * (1 - std::cos(angle)), 0));
  }
  return curve;
}

Pose CollarSeen(const Eigen::Vector3d& middle_C, double around, double lean, double roll,
                double behind_tip_m) {
  const Eigen::Vector3d view = middle_C.normalized();
  const Eigen::Vector3d down = view.cross(Eigen::Vector3d::UnitX()).normalized();
  const Eigen::Vector3d side = std::cos(around) * down.cross(view) + std::sin(around) * down;
  const Eigen::Vector3d d_C = std::cos(lean) * side + std::sin(lean) * view;
  const Eigen::Vector3d out =
      (-view + view.dot(d_C) * d_C).normalized();  // to the camera, across the shaft
  Eigen::Matrix3d R_CE;
  R_CE << d_C, out, d_C.cross(out);
  return {R_CE * ExpRotation({roll, 0, 0}), middle_C + behind_tip_m * d_C};
}

std::map<int, TagCorners> TagsInView(const CameraModel& camera, const TagCollar& collar,
                                     const Pose& T_CE, double max_angle_rad) {
  const CameraCalibration& c = camera.Calibration();
  std::map<int, TagCorners> seen;
  for (const CollarTag& tag : collar.tags) {
    const Pose T_CG = T_CE * tag.T_EG;
    if (T_CG.R.col(2).dot(T_CG.p.normalized()) < std::cos(max_angle_rad)) continue;
    const auto x_E = CornersInE(tag);
    TagCorners corners = TagDetection::NoCorners();
    bool inside = true;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto px = camera.Project(T_CE * x_E[k]);
      inside = inside && px && px->x() >= 0 && px->y() >= 0 && px->x() <= c.width_px - 1 &&
               px->y() <= c.height_px - 1;
      if (px) corners[k] = *px;
    }
    if (inside) seen[tag.id] = corners;
  }
  return seen;
}

}  // namespace flextip::bench
