// A recording of an arm made ready for its replay: joints on one time line, what was measured
// beside them, efforts that are known, rates.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "arms/model/kinematics.h"
#include "recording/recording.h"

namespace flextip::arms {

/// Rows of numbers at times since the recording's start.
struct Track {
  Eigen::VectorXd t_s;
  Eigen::MatrixXd values;  ///< a row a time

  Eigen::Index Rows() const { return values.rows(); }
};

/// Where a measurement falls on the time line of the joints.
struct Where {
  Eigen::Index row = 0;
  double fraction = 0.0;  ///< of the way to the next row
};

/// Measurements of one kind, each with its place on the joints' time line.
struct Measured {
  Track track;
  std::vector<Where> where;
  Eigen::VectorXd noise;  ///< stated standard deviation of each column

  bool Any() const { return track.Rows() > 0; }
};

struct ArmData {
  /// Throws InputError for fewer than 20 rows of joints.
  ArmData(const Recording& recording, std::string recording_name);

  /// Whether anything was measured that joints can be judged by.
  bool CanBeJudged() const { return followed.Any() || seen.Any() || pose.Any() || torque.Any(); }
  /// Throws InputError where nothing was.
  void RequireJudged() const;

  int Size() const { return arm.Size(); }
  double TypicalOf(int joint, double rad, double m) const {
    return arm.joints[joint].type == JointType::kRevolute ? rad : m;
  }

  std::string name;
  Arm arm;
  Kinematics nominal;
  Eigen::Vector3d gravity_m_s2;
  std::map<std::string, std::vector<double>> tolerances;

  bool has_encoders = false, has_command = false;
  bool at_stops = false;        ///< the arm stops at each row: nothing moves while it is seen
  Track command;                ///< as commanded; none where it was not kept
  Track joints;                 ///< encoders, or the command where there are none
  Measured followed;            ///< encoders on the command's time line
  Measured seen, pose, torque;  ///< on the joints' time line
  bool has_orientation = false;
  double registration_m = 0.0, registration_rad = 0.0;  ///< stated, of the pose's tracker

  /// Smooth rates of the joints, on their time line; none at stops.
  Eigen::MatrixXd smooth, rate, acceleration;
  /// Efforts that the joints hold, on the time lines of joints and command (known joints alone).
  Eigen::MatrixXd effort_at_joints, effort_at_command;
  std::vector<bool> effort_known;  ///< a joint
};

/// Returns row `where` of the track, between two rows linearly.
Eigen::RowVectorXd At(const Eigen::MatrixXd& values, const Where& where);
double At(const Eigen::VectorXd& values, const Where& where);

}  // namespace flextip::arms
