// A cycle around a stop: what the controller was given and did, and where each sensor has the tip.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>

#include "control/supervision/stops.h"
#include "pipeline/sensor_readings.h"

namespace flextip {

/// In R (m, N, rad).
struct Moment {
  TimeNs t_ns = 0;
  SensorReadings readings;  ///< as the controller was given them
  std::optional<Eigen::Vector3d> p_RE_wanted;
  std::optional<Eigen::Vector3d> p_RE_used;  ///< the tip as the controller took it
  Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();
  std::optional<Eigen::Vector3d> p_RW_sent;  ///< the command of this cycle
  const char* cause = "";                    ///< what holds; empty: nothing does
  Supervision supervision;
};

}  // namespace flextip
