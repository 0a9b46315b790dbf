// The sensors' measurements of an instant, in R; absent fields were not measured.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>

#include "core/pose.h"
#include "core/tip_observation.h"

namespace flextip {

struct EmMeasurement {
  Pose T_RS;  ///< sensor on the shaft, its x along the shaft
  double distance_from_tip_m = 0.0;
  double position_noise_m = 0.0;  ///< standard deviation per axis
  double orientation_noise_rad = 0.0;
};

/// Moments m1_y, m1_z, m2_y, m2_z of the part beyond on the part before, about the wrist frame's
/// y and z carried along the shaft without twist.
struct StrainMeasurement {
  Eigen::Vector4d moments_Nm = Eigen::Vector4d::Zero();
  double station_from_wrist_m[2] = {0.0, 0.0};
  double moment_noise_Nm = 0.0;
};

struct LoadMeasurement {
  Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();
  double force_noise_N = 0.0;
};

struct Measurements {
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();
  double wrist_position_noise_m = 0.0;
  std::optional<Eigen::Matrix3d> R_RW;  ///< measured orientation of the free wrist joint
  double wrist_orientation_noise_rad = 0.0;
  std::optional<TipObservation> tip;  ///< by vision; its d_RE where the direction was seen
  double tip_direction_noise_rad = 0.0;
  std::optional<EmMeasurement> em;
  std::optional<Eigen::Vector3d> port_direction;  ///< the shaft's direction at the port (em1), unit
  double port_direction_noise_rad = 0.0;
  std::optional<StrainMeasurement> strain;
  std::optional<LoadMeasurement> load;
};

/// Returns whether every number that is there can be a measurement: finite, places within
/// kFarthestPlace_m, directions and rotations of unit length, covariances symmetric without
/// negative values, noises not negative. A tip that is lost is not looked at.
bool IsPlausible(const Measurements& measurements);

/// What is held against the rest: the wrist's reading, its direction, and the sensors.
inline constexpr int kComparedSensors = 7;

/// By how much chi-squared of a fit falls where one sensor is left out, by the fit's linear model;
/// distributed as chi-squared with `degrees` degrees of freedom where nothing is wrong.
struct SensorMisfit {
  double chi2 = 0.0;
  int degrees = 0;  ///< 0: there is no such sensor
};
using SensorMisfits = std::array<SensorMisfit, kComparedSensors>;

}  // namespace flextip
