// Cameras, collars and shafts for the tests of the laparoscope, and projection by OpenCV, which the
// renderer does not use.
#pragma once

#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <vector>

#include "core/camera.h"
#include "core/pose.h"
#include "core/tag_collar.h"
#include "simulation/plant/shaft_curve.h"
#include "simulation/render/laparoscope.h"

namespace flextip::render_test {

/// A small camera at the origin of R that looks along z.
inline CameraCalibration SmallCamera() {
  CameraCalibration camera;
  camera.width_px = 320;
  camera.height_px = 240;
  camera.fu_px = 300;
  camera.fv_px = 297;
  camera.cu_px = 161.3;
  camera.cv_px = 118.6;
  camera.gamma = 1.0;
  return camera;
}

inline std::vector<CameraCalibration> SmallCameras() {
  CameraCalibration plain = SmallCamera(), radial = plain, rational = plain, fisheye = plain;
  radial.distortion_coefficients = {-0.22, 0.08, 0.0006, -0.0004};
  rational.distortion = Distortion::kOpenCv;
  rational.distortion_coefficients = {-0.3, 0.1, 0.001, -0.002, -0.02, 0.05, 0.01, -0.003};
  fisheye.distortion = Distortion::kEquidistant;
  fisheye.distortion_coefficients = {-0.02, 0.01, -0.004, 0.001};
  return {plain, radial, rational, fisheye};
}

/// The camera of the rendered sample, in its place in R.
inline CameraCalibration SampleCamera() {
  CameraCalibration camera;
  camera.width_px = 1280;
  camera.height_px = 720;
  camera.fu_px = camera.fv_px = 950;
  camera.cu_px = 646.5;
  camera.cv_px = 355.5;
  camera.distortion_coefficients = {-0.22, 0.08, 0.0006, -0.0004};
  camera.T_RC.R << -0.960714183, -0.243075713, 0.133949456, -0.277539653, 0.841415929, -0.463671194,
      0, -0.482631777, -0.875823366;
  camera.T_RC.p << 0.185158286, 0.0438706152, 0.084375857;
  return camera;
}

/// The sample's collar: six 5 mm tags around the shaft, 30 mm behind the tip.
inline TagCollar HexagonCollar() {
  TagCollar collar;
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3;
    const Eigen::Vector3d out(0, std::cos(angle), std::sin(angle));
    CollarTag tag{i, 0.005, {}};
    tag.T_EG.R.col(0) = Eigen::Vector3d::UnitX();
    tag.T_EG.R.col(2) = -out;
    tag.T_EG.R.col(1) = tag.T_EG.R.col(2).cross(tag.T_EG.R.col(0));
    tag.T_EG.p = 0.005 * out + Eigen::Vector3d(-0.03, 0, 0);
    collar.tags.push_back(tag);
  }
  return collar;
}

/// No texture, no blur, no noise, linear.
inline simulation::LaparoscopeOptions PlainOptions() {
  simulation::LaparoscopeOptions options;
  options.tissue.point_R = {0, 0, 0.2};
  options.tissue.normal_R = {0, 0, -1};
  options.tissue.texture_contrast = options.tissue.relief_m = options.tissue.wetness = 0;
  options.tissue.albedo_bgr = {0.5, 0.5, 0.5};
  options.exposure_distance_m = 0.1;
  options.vignetting = 0;
  options.blur_sigma_px = options.full_well_electrons = 0;
  options.gamma = 1.0;
  return options;
}

/// A shaft on the arc of a circle of `radius_m` that ends at T_RE, bending toward E's y axis.
inline simulation::ShaftCurve ArcShaft(const Pose& T_RE, double length_m, double radius_m,
                                       double diameter_m) {
  simulation::ShaftCurve curve;
  curve.diameter_m = diameter_m;
  curve.T_RE = T_RE;
  constexpr int kPieces = 60;
  for (int i = 0; i <= kPieces; ++i) {
    const double angle = length_m * (1.0 - i / static_cast<double>(kPieces)) / radius_m;
    curve.points.push_back(
        T_RE * Eigen::Vector3d(-radius_m * std::sin(angle), radius_m * (1 - std::cos(angle)), 0));
  }
  return curve;
}

/// A shaft far out of the picture.
inline simulation::ShaftCurve HiddenShaft() {
  Pose behind;
  behind.p = {0, 0, -5};
  return ArcShaft(behind, 0.3, 10, 0.005);
}

/// Pixels of points in the camera frame, by cv::projectPoints or cv::fisheye::projectPoints.
inline std::vector<Eigen::Vector2d> Project(const CameraCalibration& camera,
                                            const std::vector<Eigen::Vector3d>& points_C) {
  std::vector<cv::Point3d> x;
  for (const Eigen::Vector3d& p : points_C) x.emplace_back(p.x(), p.y(), p.z());
  const cv::Matx33d K(camera.fu_px, 0, camera.cu_px, 0, camera.fv_px, camera.cv_px, 0, 0, 1);
  std::vector<cv::Point2d> px;
  const cv::Vec3d zero(0, 0, 0);
  if (camera.distortion == Distortion::kEquidistant) {
    cv::fisheye::projectPoints(x, px, zero, zero, K, camera.distortion_coefficients);
  } else {
    cv::projectPoints(x, zero, zero, K, camera.distortion_coefficients, px);
  }
  std::vector<Eigen::Vector2d> result;
  for (const cv::Point2d& p : px) result.emplace_back(p.x, p.y);
  return result;
}

}  // namespace flextip::render_test
