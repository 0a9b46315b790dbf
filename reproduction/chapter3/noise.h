// The worst that bounded sensor noise does to chapter 3's estimates. Private to reproduction.
#pragma once

#include <cstdint>

#include "reproduction/chapter3/beam.h"

namespace flextip::reproduction {

/// Of each sensor axis.
struct SensorNoiseLevel {
  double position_m = 0.0;
  double angle_rad = 0.0;

  BeamReadings Bounds() const;
};

/// What an estimate is worth.
struct EstimateErrors {
  double metric = 0.0;  ///< (2.6) of its Jacobian against the true state's, of the same form
  double force = 0.0;   ///< error of F_p/EI, relative
  double port_m = 0.0;
};

EstimateErrors ErrorsOf(FlexionForm form, const BeamState& truth, const BeamState& estimate);

struct WorstErrors {
  /// The largest over all errors within the bounds; infinite where the box holds a noise for which
  /// the estimate's Jacobian is singular (metric) or its port at an end of the shaft (force).
  EstimateErrors worst;
  /// Of the 64 corners alone, as they come out.
  EstimateErrors corners;
};

/// Each sensor's error anywhere within its bound: corners, middles of edges and faces (3^6 points),
/// then a search along the axes from the worst.
WorstErrors WorstOverNoise(FlexionForm form, const BeamState& truth, const SensorNoiseLevel& bound);

/// Median, root of the mean square (of what is finite) and mean of the metric under Gaussian noise
/// with these standard deviations.
struct TypicalMetric {
  double median = 0.0, rms = 0.0, mean = 0.0;
};
TypicalMetric MetricUnderGaussianNoise(FlexionForm form, const BeamState& truth,
                                       const SensorNoiseLevel& sd, int draws, std::uint64_t seed);

}  // namespace flextip::reproduction
