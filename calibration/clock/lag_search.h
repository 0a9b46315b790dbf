// The coarse offset between two clocks: where the speeds of two motions are alike, and how well one
// motion predicts the other at every offset.
#pragma once

#include <vector>

#include "calibration/clock/smooth_motion.h"

namespace flextip {

/// Returns the offsets (s, of the target's clock: reference time = target time + offset) with the
/// highest correlation of speed, best first; local maxima at least 0.1 s apart, at most `count`.
/// Empty where the streams overlap for less than `least_overlap_s` at every offset.
std::vector<double> LikelyOffsets(const SmoothMotion& target, int target_rows,
                                  const SmoothMotion& reference, int reference_rows,
                                  double most_offset_s, double least_overlap_s, std::size_t count);

/// How well the reference predicts the target, linearly, at each offset.
struct MisfitProfile {
  std::vector<double> offset_s;
  std::vector<double> misfit;  ///< residual over variance of the target's values, 0 to 1; NaN where
                               ///< the overlap is too short
};

/// Returns the profile on a grid of 0.05 s. Looks at 1500 of the target's samples at most.
MisfitProfile MisfitOver(const Motion& target, const SmoothMotion& reference, double most_offset_s,
                         double least_overlap_s);

/// Returns the misfit at a single offset; NaN where the overlap is too short.
double MisfitAt(const Motion& target, const SmoothMotion& reference, double offset_s,
                double least_overlap_s);

struct OffsetMisfit {
  double offset_s = 0.0, misfit = 1.0;
};

/// Returns the least misfit outside the valley around `offset_s`, and where; a misfit of 1 where
/// there is none.
OffsetMisfit NextBest(const MisfitProfile& profile, double offset_s);

}  // namespace flextip
