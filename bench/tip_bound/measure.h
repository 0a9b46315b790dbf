// How near the bound the estimates come: many noisy frames of one scene.
#pragma once

#include "bench/tip_bound/scene.h"

namespace flextip::bench {

/// Over the frames in which the estimator gave a tip.
struct TipScore {
  int frames = 0, found = 0;
  double rms_m = 0.0;   ///< error of the tip's position
  double bias_m = 0.0;  ///< the mean error's length
  double nees = 0.0;  ///< mean normalised squared error of the tip; 3 when the covariance is right
};

/// The tracker (TipTracker::Track) on `frames` noisy pictures of the scene; a few more before them
/// are not counted.
TipScore MeasureTracker(const simulation::Laparoscope& laparoscope,
                        const simulation::LaparoscopeOptions& options, const TagCollar& collar,
                        const TubeShape& tube, const BoundScene& scene, int frames);

/// The outline alone (ShaftContour::Fit), from predictions some pixels off.
TipScore MeasureContour(const simulation::Laparoscope& laparoscope,
                        const simulation::LaparoscopeOptions& options, const TubeShape& tube,
                        const BoundScene& scene, int frames);

}  // namespace flextip::bench
