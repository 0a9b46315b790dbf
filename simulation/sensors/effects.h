// Effects of sensors that are not in their data sheets (names and parameters as in docs/effects.md;
// the forms are the simulation's own). Neutral values: no effect.
#pragma once

#include <Eigen/Dense>
#include <limits>

namespace flextip::simulation {

/// A motor or a mains harmonic that swings the EM position: amplitude x sin(2 pi f t + phase).
struct Interference {
  Eigen::Vector3d amplitude_m = Eigen::Vector3d::Zero();
  double frequency_hz = 0.0, phase_rad = 0.0;
};

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
  double gage_rotation_rad = 0.0;  ///< of the gages about the shaft's axis, against the wrist's
  /// What a gage (row) reads of another's moment (column); the diagonal stays zero.
  Eigen::Matrix4d strain_crosstalk = Eigen::Matrix4d::Zero();
  /// Clocks of their own: what is stamped t was taken at t + rate (t - t0).
  double em_clock_rate = 0.0, camera_clock_rate = 0.0;
  double load_scale = 1.0;  ///< the load cell reads this times the force,
  Eigen::Vector3d load_rotation_rad = Eigen::Vector3d::Zero();  ///< turned by this
  /// Of the lens beyond its calibration: the image is displaced by the factor 1 + k1 r^2.
  double lens_k1 = 0.0;
  /// Of the camera about its own place, and of that place, as it sinks evenly in time.
  Eigen::Vector3d camera_drift_rad_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d camera_drift_m_s = Eigen::Vector3d::Zero();
  Interference em_interference;

  // Not in the catalogue.
  double strain_limit_Nm = std::numeric_limits<double>::infinity();  ///< gages clip here
  double noise_scale = 1.0;        ///< of every sensor against its data sheet
  double noise_correlation = 0.0;  ///< AR(1) coefficient from sample to sample, same variance
};

}  // namespace flextip::simulation
