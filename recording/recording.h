// A recording in memory: every stream of docs/formats.md, without the truth (see truth.h), which
// nothing but scoring may read.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/camera.h"
#include "core/instrument.h"
#include "core/tag_collar.h"
#include "core/time_series.h"
#include "core/tip_observation.h"
#include "recording/arm/arm.h"

namespace flextip {

/// How well a stream's times are known once a calibration put its clock right. Nothing is stated:
/// exactly.
struct ClockNoise {
  TimeNs origin_ns = 0;
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of offset (s) at the origin, and rate

  /// Returns the deviation of a time near `t_ns` (s).
  double SdAt(TimeNs t_ns) const {
    const Eigen::Vector2d by(1.0, 1e-9 * static_cast<double>(t_ns - origin_ns));
    return std::sqrt(std::max(0.0, by.dot(covariance * by)));
  }
  /// Adds that of a further clock put right, which goes on from here.
  void Add(const ClockNoise& next) {
    Eigen::Matrix2d later = Eigen::Matrix2d::Identity();
    later(0, 1) = 1e-9 * static_cast<double>(next.origin_ns - origin_ns);
    covariance = later * covariance * later.transpose() + next.covariance;
    origin_ns = next.origin_ns;
  }
};

/// The wrist as the robot's encoders give it; the orientation only where it is measured.
struct WristSample {
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();
  std::optional<Eigen::Quaterniond> q_RW;
};
struct WristStream {
  std::string comment;
  double rate_hz = 0.0;
  double position_noise_m = 0.0;  ///< standard deviation per axis, as all noises here
  double orientation_noise_rad = 0.0;
  Series<WristSample> samples;
  ClockNoise clock = {};
};

struct CommandStream {
  std::string comment;
  double rate_hz = 0.0;
  Series<Eigen::Vector3d> p_RW;
};

enum class NoiseDistribution { kGaussian, kUniform };

struct EmSample {
  Eigen::Vector3d p_RS = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_RS = Eigen::Quaterniond::Identity();
};
/// An electromagnetic sensor on the shaft (em0) or on the port (em1, orientation only).
struct EmStream {
  std::string comment;
  double rate_hz = 0.0;
  double distance_from_tip_m = 0.0;
  double position_noise_m = 0.0;
  double orientation_noise_rad = 0.0;
  NoiseDistribution noise_distribution = NoiseDistribution::kGaussian;
  double registration_noise_rad = 0.0;  ///< how well the sensor's frame is known in R
  double registration_noise_m = 0.0;
  Series<EmSample> samples;
  ClockNoise clock = {};
};

/// Internal bending moments m1_y, m1_z, m2_y, m2_z (Nm) of the part beyond on the part before,
/// about the y and z axes of the wrist frame carried along the shaft without twist.
struct StrainStream {
  std::string comment;
  double rate_hz = 0.0;
  double station_from_wrist_m[2] = {0.0, 0.0};
  double moment_noise_Nm = 0.0;
  Series<Eigen::Vector4d> moments_Nm;
};

/// The force on the tip, in R (N), where it is known.
struct LoadStream {
  std::string comment;
  double rate_hz = 0.0;
  double force_noise_N = 0.0;
  Series<Eigen::Vector3d> f_tip_N;
};

/// Frames as image files under cam0/data/, or as frame numbers of a video; either may be absent
/// (only the calibration is kept then).
struct CameraStream {
  std::string comment;
  CameraCalibration calibration;
  bool has_T_RC = true;           ///< else its pose is unknown, and calibration.T_RC the identity
  std::string video;              ///< file name inside cam0/, empty for image files
  Series<std::string> filenames;  ///< image files
  Series<int> frame_numbers;      ///< frames of `video`
};

struct VisionStream {
  std::string comment;
  double rate_hz = 0.0;
  std::string camera = "cam0";
  double direction_noise_rad = 0.0;
  double registration_noise_rad = 0.0;
  double registration_noise_m = 0.0;
  Series<TipObservation> tips;
  ClockNoise clock = {};
};

/// Joints of an arm, one number a joint: as the encoders measured (joints0), as commanded
/// (joints_command0) or as an outside sensor saw them (joints_seen0).
struct JointStream {
  std::string comment;
  double rate_hz = 0.0;
  std::vector<JointType> types;
  std::vector<double> noise;  ///< one a joint, rad or m
  Series<Eigen::VectorXd> q;
};

/// Efforts of the joints, the first so many of the arm's.
struct TorqueStream {
  std::string comment;
  double rate_hz = 0.0;
  std::vector<JointType> types;
  std::vector<double> noise;  ///< one a joint, Nm or N
  Series<Eigen::VectorXd> tau;
};

/// The arm's last link, or a marker on it, by an outside tracker.
struct PoseSample {
  Eigen::Vector3d p_RK = Eigen::Vector3d::Zero();
  std::optional<Eigen::Quaterniond> q_RK;
};
struct PoseStream {
  std::string comment;
  double rate_hz = 0.0;
  double position_noise_m = 0.0;
  double orientation_noise_rad = 0.0;
  double registration_noise_rad = 0.0;  ///< how well the tracker's frame is known in R
  double registration_noise_m = 0.0;
  Series<PoseSample> samples;
};

struct Recording {
  bool has_shaft = true;  ///< a shaft through a port; else instrument and port mean nothing
  Instrument instrument;
  Eigen::Vector3d p_RP = Eigen::Vector3d::Zero();  ///< the port as registered
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.81};
  std::map<std::string, std::vector<double>> tolerances;  ///< "effect.parameter": values
  std::optional<WristStream> wrist0;
  std::optional<CommandStream> command0;
  std::optional<EmStream> em0, em1;
  std::optional<StrainStream> strain0;
  std::optional<LoadStream> load0;
  std::optional<CameraStream> cam0, cam1;  ///< cam1: a stereo laparoscope's other eye
  std::optional<TagCollar> tags0;
  std::optional<VisionStream> vision0;
  std::optional<Arm> arm;  ///< there with every stream of joints
  std::optional<JointStream> joints0, joints_command0, joints_seen0;
  std::optional<TorqueStream> torque0;
  std::optional<PoseStream> pose0;

  /// Whether there are joints from which an arm's motion can be told.
  bool HasArm() const { return joints0 || (joints_command0 && joints_seen0); }
};

}  // namespace flextip
