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

/// Returns the offsets where the profile has its least minima, best first, at most `count`.
std::vector<double> BestOffsets(const MisfitProfile& profile, std::size_t count);

}  // namespace flextip
