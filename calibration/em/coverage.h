// Whether the space a sensor went through is enough for a registration and for a field.
#pragma once

#include <string>
#include <vector>

#include "calibration/em/choice.h"

namespace flextip {

/// The box around the places, and how it is filled.
struct EmCoverage {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero(), scale_m = Eigen::Vector3d::Ones();
  Eigen::Vector3d spread_m = Eigen::Vector3d::Zero();  ///< rms along the principal axes, ascending
  int places = 0;
  int cells = 0;  ///< of 3 x 3 x 3 with a place in them
};
EmCoverage CoverageOf(const std::vector<Eigen::Vector3d>& places);

/// No field, orders 1 to 3, splines with five a side of three softnesses, all with the distance
/// held: a field can take its place. Those that the coverage does not bear have their reason.
std::vector<EmCandidate> FieldCandidates(const EmCoverage& coverage);

}  // namespace flextip
