// The exact rod in chapter 3's place: what the beam would be told and how far off it is. Private to
// reproduction.
#pragma once

#include "reproduction/chapter3/beam.h"

namespace flextip::reproduction {

/// A rod bent in the plane, the force on its tip square to its chord as the beam's is.
struct PlaneRodState {
  double depth_m = 0.0;  ///< from port to tip
  BeamReadings readings = BeamReadings::Zero();
  Eigen::Matrix2d J_tip_wrist = Eigen::Matrix2d::Zero();  ///< its force held constant
  BeamState lever;  ///< an unbent shaft through the same wrist and port
};

/// The rod with its port `distance_m` from the wrist, 0 < distance < length.
PlaneRodState PlaneRodAt(const BentShaft& shaft, double distance_m);

}  // namespace flextip::reproduction
