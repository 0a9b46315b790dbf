// Loads that could be hung next, for the advice of calibrations.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calibration/shaft/known_loads.h"

namespace flextip {

struct PlacedHold {
  LoadHold hold;
  double s_port_m = 0.0;  ///< of the port, from the wrist along the shaft
};

struct NextLoad {
  LoadHold hold;      ///< load, wrist and noises; the rest is that of a hold of the recording
  std::string words;  ///< "0.3 N along the wrist's y axis, with the port 0.280 m from the wrist"
};

/// The wrist where it was with the port nearest to, midway, and furthest along the shaft, and each
/// drawn back or pushed on by up to a fifth of that; the largest force there was each way across
/// the shaft, and none.
std::vector<NextLoad> NextLoads(std::vector<PlacedHold> holds, const Eigen::Vector3d& p_RP);

}  // namespace flextip
