// A recording as the diagnosis sees it: one sample for each time of the wrist, with every sensor's
// nearest reading.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <bitset>
#include <map>
#include <string>
#include <vector>

#include "core/instrument.h"
#include "core/pose.h"
#include "diagnosis/replay/sample_input.h"
#include "recording/recording.h"

namespace flextip::diagnosis {

/// Measured values; which of them are there is said by `present`, row by row.
struct DiagnosisSample {
  double t_s = 0.0;                                    ///< since the first sample
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();      ///< smoothed as far as noise allows
  double p_RW_noise_m = 0.0;                           ///< remaining noise, per axis
  Eigen::Vector3d y_wrist = Eigen::Vector3d::UnitY();  ///< the instrument's y axis, in R
  std::bitset<row::kCount> present;
  /// A sensor's reading, judged (present) or not: late sensors speak of other samples.
  std::bitset<row::kCount> spoken;
  Eigen::Vector3d d_wrist = Eigen::Vector3d::UnitX();  ///< shaft's direction at the wrist
  Eigen::Vector3d p_RS = Eigen::Vector3d::Zero();      ///< EM sensor
  Eigen::Vector3d d_em = Eigen::Vector3d::UnitX();
  Eigen::Vector4d moments_Nm = Eigen::Vector4d::Zero();
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();  ///< tip by vision
  Eigen::Matrix3d p_RE_covariance_m2 = Eigen::Matrix3d::Zero();
  Eigen::Vector3d d_tip = Eigen::Vector3d::UnitX();
  Eigen::Vector3d d_port = Eigen::Vector3d::UnitX();
  Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();  ///< where the load is known
  double force_noise_N = 0.0;                         ///< of f_tip_N, per axis
  /// The same as the samples around say, whose noise is another: what a load cell misreads goes
  /// with the force, and must not look like its noise. Where they say another force: f_tip_N.
  Eigen::Vector3d f_around_N = Eigen::Vector3d::Zero();
  /// When sensors spoke, less t_s: EM, strain, vision, the port's sensor.
  double dt_em_s = 0.0, dt_strain_s = 0.0, dt_tip_s = 0.0, dt_port_s = 0.0;

  bool Has(int first_row) const { return present[first_row]; }
};

struct SensorNoises {  // standard deviations per axis, by the data sheets
  double wrist_position_m = 0.0, wrist_direction_rad = 0.0;
  double em_position_m = 0.0, em_direction_rad = 0.0;
  double moment_Nm = 0.0, force_N = 0.0;
  double tip_direction_rad = 0.0, port_direction_rad = 0.0;
  double em_registration_rad = 0.0, em_registration_m = 0.0;
  double vision_registration_rad = 0.0, vision_registration_m = 0.0;
};

struct SampleSet {
  Instrument instrument;
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d::Zero();
  std::map<std::string, std::vector<double>> tolerances;
  SensorNoises noise;
  double em_from_tip_m = 0.0;
  std::array<double, 2> strain_from_wrist_m{0.0, 0.0};
  bool has_em = false, has_strain = false, has_tip = false, has_tip_direction = false;
  bool has_wrist_direction = false, has_port_direction = false, has_load = false;
  bool has_camera = false;  ///< T_RC is known
  Pose T_RC;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< of the EM or vision positions, in R
  double period_s = 0.0;                             ///< between samples, the median
  bool resolved_in_time = true;                      ///< the motion from sample to sample is smooth
  std::vector<DiagnosisSample> samples;
  std::vector<std::string> warnings;

  /// Returns whether a load cell reads more than its noise: of noise no scale can be told.
  bool LoadStandsOut() const {
    constexpr double kOverNoise = 10.0;
    double force2 = 0.0, noise2 = 0.0;
    for (const DiagnosisSample& sample : samples) {
      force2 += sample.f_tip_N.squaredNorm();
      noise2 += 3.0 * sample.force_noise_N * sample.force_noise_N;
    }
    return has_load && force2 > kOverNoise * kOverNoise * noise2;
  }

  double Duration() const {
    return samples.empty() ? 0.0 : samples.back().t_s - samples.front().t_s;
  }
};

/// Throws InputError, in one line that starts with `name`, where nothing can be judged: no wrist,
/// too few samples, or no sensor that says more than is needed to know the load. A sensor that
/// always says the same, gages whose axes are unknown, and single readings apart from those around
/// them (outliers.h) are left out with a warning.
SampleSet MakeSampleSet(const Recording& recording, const std::string& name);

}  // namespace flextip::diagnosis
