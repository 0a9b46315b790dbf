// Effects of sensors that are not in their data sheets (names and parameters as in docs/effects.md;
// the forms are the simulation's own). Neutral values: no effect.
#pragma once

#include <Eigen/Dense>
#include <limits>

namespace flextip::simulation {

struct SensorEffects {
  /// The EM field's distortion: position bias = gradient (p - p_centre) + a smooth rest of higher
  /// order (a dipole among metal) of `em_curvature` times the linear part at 0.1 m.
  Eigen::Matrix3d em_gradient = Eigen::Matrix3d::Zero();
  Eigen::Vector3d em_centre_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d em_offset_m = Eigen::Vector3d::Zero();  ///< of the position, everywhere
  double em_curvature = 0.0;
  double em_latency_s = 0.0;      ///< samples are stamped late by this
  double camera_latency_s = 0.0;  ///< frames likewise
  /// The camera truly is at Exp(rotation) R_RC, p_RC + translation (in R) when T_RC was registered.
  Eigen::Vector3d hand_eye_rotation_rad = Eigen::Vector3d::Zero();
  Eigen::Vector3d hand_eye_translation_m = Eigen::Vector3d::Zero();
  double focal_scale = 1.0;                                ///< true focal length over calibrated
  Eigen::Vector3d tag_offset_m = Eigen::Vector3d::Zero();  ///< in E: where the tags truly are
  Eigen::Vector4d strain_gain = Eigen::Vector4d::Ones();
  Eigen::Vector4d strain_drift_Nm_s = Eigen::Vector4d::Zero();

  // Not in the catalogue.
  double strain_limit_Nm = std::numeric_limits<double>::infinity();  ///< gages clip here
  double noise_scale = 1.0;        ///< of every sensor against its data sheet
  double noise_correlation = 0.0;  ///< AR(1) coefficient from sample to sample, same variance
};

}  // namespace flextip::simulation
