// The shaft's shape as the plant gives it to the sensors and to the laparoscope.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "core/pose.h"

namespace flextip::simulation {

/// The centre line from wrist to tip, in R, and the tip's frame.
struct ShaftCurve {
  std::vector<Eigen::Vector3d> points;  ///< at least two, from the wrist (first) to the tip (last)
  double diameter_m = 0.0;
  Pose T_RE;  ///< x along the shaft at the tip
};

}  // namespace flextip::simulation
