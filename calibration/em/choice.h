// The choice of the field, by its prediction of data left out of the fit.
#pragma once

#include <string>
#include <vector>

#include "calibration/em/fit.h"

namespace flextip {

struct EmCandidate {
  std::string name = {};  ///< "no field", "order 1", "spline 5"
  EmDesign design = {};
  bool tried = false;
  double heldout_rms_m = 0.0;  ///< per component, in parts of space left out of the fit
  /// Gain over the best simpler one (whitened squares), in standard errors over the parts of space.
  double gain_sigmas = 0.0;
  bool chosen = false;
  std::string reason = {};  ///< why it was not tried
};

/// Returns the part of space of each place: sixteen parts with equal numbers, cut again and again
/// across their longest side.
std::vector<int> PartsOfSpace(const std::vector<Eigen::Vector3d>& places);

/// Tries every candidate whose `reason` is empty, from the simplest on: each part of space is
/// predicted by a fit to the others, linear about `start` (a fit without field). A candidate
/// replaces a simpler one where its gain is more than chance would give.
void ChooseField(const std::vector<EmPair>& pairs, const EmSolution& start,
                 std::vector<EmCandidate>& candidates);

}  // namespace flextip
