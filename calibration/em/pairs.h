// Where an EM sensor says it is beside where wrist or camera say it must be.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "core/pose.h"
#include "core/time_series.h"
#include "recording/recording.h"

namespace flextip {

struct EmPair {
  TimeNs t_ns = 0;
  Pose T_FS;                                             ///< as measured
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();        ///< the tip by the reference
  Eigen::Vector3d t_RE = Eigen::Vector3d::UnitX();       ///< the shaft's direction there, unit
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of sensor less reference, as stated
};

struct EmPairs {
  std::vector<EmPair> pairs;
  int left_out = 0;  ///< sensor samples without a reference
  std::vector<std::string> warnings;
};

/// Pairs the sensor with its place on the straight shaft from wrist0 through the port, at each of
/// the sensor's samples. Needs em0 and wrist0.
EmPairs PairByWrist(const Recording& recording);
/// Pairs the sensor with its place behind the tip of vision0, at each `ok` frame with a direction.
/// Needs em0 and vision0.
EmPairs PairByVision(const Recording& recording);

}  // namespace flextip
