// Poses of a body that turns about its tip, with noise as stated or otherwise.
#pragma once

#include <random>
#include <vector>

#include "calibration/tip/pivot.h"
#include "core/draw_vector.h"
#include "core/rotation.h"

namespace flextip {

struct PivotScene {
  int poses = 60;
  Eigen::Vector3d p_BE{0.35, 0.01, -0.02}, p_R{0.1, -0.2, 0.3};
  Eigen::Vector3d turn_sd_rad{0.3, 0.3, 0.3};  ///< about B's axes
  double position_noise_m = 2e-4, orientation_noise_rad = 5e-4;
  double position_true = 1.0, orientation_true = 1.0;  ///< true noise over stated
  double correlation = 0.0;                            ///< of the noise from pose to pose
};

inline std::vector<PivotPose> DrawPivot(const PivotScene& scene, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto draw = [&] { return DrawVector<3>(normal, random); };
  Eigen::Vector3d w = draw(), p = draw();
  const double a = scene.correlation, b = std::sqrt(1 - a * a);
  std::vector<PivotPose> poses;
  for (int i = 0; i < scene.poses; ++i) {
    PivotPose pose;
    pose.t_ns = i * TimeNs{20'000'000};
    const Eigen::Matrix3d R =
        ExpRotation({0.4, -1.0, 2.0}) * ExpRotation(scene.turn_sd_rad.cwiseProduct(draw()));
    w = a * w + b * draw();
    p = a * p + b * draw();
    pose.T_RB.R = ExpRotation(scene.orientation_true * scene.orientation_noise_rad * w) * R;
    pose.T_RB.p = scene.p_R - R * scene.p_BE + scene.position_true * scene.position_noise_m * p;
    const double vw = std::pow(scene.orientation_noise_rad, 2),
                 vp = std::pow(scene.position_noise_m, 2);
    pose.covariance.diagonal() << vw, vw, vw, vp, vp, vp;
    poses.push_back(pose);
  }
  return poses;
}

}  // namespace flextip
