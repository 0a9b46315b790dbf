#include "simulation/sensors/camera_view.h"

#include <array>

#include "core/linear_algebra.h"
#include "core/rotation.h"

namespace flextip::simulation {
namespace {

/// Corners of a collar around the tip, in E.
std::array<Eigen::Vector3d, 8> CollarPoints() {
  std::array<Eigen::Vector3d, 8> points;
  for (int i = 0; i < 8; ++i) {
    points[i] = {(i & 1) ? 0.006 : -0.006, (i & 2) ? 0.005 : -0.005, (i & 4) ? 0.005 : -0.005};
  }
  return points;
}

/// The image of a direction by a lens of focal length `scale` that distorts by `k1` beyond its
/// calibration.
Eigen::Vector2d Image(const Eigen::Vector3d& seen, double scale, double k1) {
  const Eigen::Vector2d at = seen.head<2>() / seen.z();
  return scale * (1.0 + k1 * at.squaredNorm()) * at;
}

/// The pose whose projections with focal length 1 are nearest to those of `T_CE` by the true lens,
/// by Gauss-Newton from the first-order answer.
Pose SolveBack(const Pose& T_CE, double scale, double k1) {
  const auto points = CollarPoints();
  Pose pose = T_CE;
  pose.p.z() /= scale;
  for (int iteration = 0; iteration < 6; ++iteration) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d seen = T_CE * point;
      const Eigen::Vector3d turned = pose.R * point, x = turned + pose.p;
      const Eigen::Vector2d residual =
          Image(seen, scale, k1) - Eigen::Vector2d(x.head<2>() / x.z());
      Eigen::Matrix<double, 2, 3> by_x;
      by_x << 1, 0, -x.x() / x.z(), 0, 1, -x.y() / x.z();
      by_x /= x.z();
      Eigen::Matrix<double, 2, 6> J;
      J << by_x, -by_x * Skew(turned);
      normal += J.transpose() * J;
      right += J.transpose() * residual;
    }
    const Eigen::Matrix<double, 6, 1> step = Ldlt(normal).Solve(right);
    pose.p += step.head<3>();
    pose.R = ExpRotation(step.tail<3>()) * pose.R;
    if (step.norm() < 1e-10) break;
  }
  return pose;
}

}  // namespace

Pose SeenTip(const Pose& T_RE, const Pose& T_RC, const SensorEffects& effects, double t_s) {
  const Pose tags{T_RE.R, T_RE * effects.tag_offset_m};
  const Pose true_camera{
      ExpRotation(effects.hand_eye_rotation_rad + t_s * effects.camera_drift_rad_s) * T_RC.R,
      T_RC.p + effects.hand_eye_translation_m + t_s * effects.camera_drift_m_s};
  const Pose T_CE = true_camera.Inverse() * tags;
  if (effects.focal_scale == 1.0 && effects.lens_k1 == 0.0) return T_RC * T_CE;
  return T_RC * SolveBack(T_CE, effects.focal_scale, effects.lens_k1);
}

CameraCalibration TrueCamera(const CameraCalibration& registered, const SensorEffects& effects) {
  CameraCalibration camera = registered;
  camera.T_RC.R = ExpRotation(effects.hand_eye_rotation_rad) * registered.T_RC.R;
  camera.T_RC.p += effects.hand_eye_translation_m;
  camera.fu_px *= effects.focal_scale;
  camera.fv_px *= effects.focal_scale;
  if (!camera.distortion_coefficients.empty()) camera.distortion_coefficients[0] += effects.lens_k1;
  return camera;
}

TagCollar TrueCollar(const TagCollar& stated, const SensorEffects& effects) {
  TagCollar collar = stated;
  for (CollarTag& tag : collar.tags) tag.T_EG.p += effects.tag_offset_m;
  return collar;
}

}  // namespace flextip::simulation
