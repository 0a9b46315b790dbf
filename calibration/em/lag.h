// Whether an EM sensor's times are those of its reference.
#pragma once

#include <vector>

#include "calibration/em/pairs.h"

namespace flextip {

/// By how much the sensor is late behind the reference, from errors along its velocity: a fit to
/// `errors_R` (sensor less reference, m) of the pairs that are `used`, in the order of time.
/// `sd_s` 0: nothing moved.
struct EmLag {
  double late_s = 0.0, sd_s = 0.0;
};
EmLag LagOf(const std::vector<EmPair>& pairs, const std::vector<Eigen::Vector3d>& errors_R,
            const std::vector<bool>& used, double distance_m);

}  // namespace flextip
