// Nuisances (a tracker's place, masses, what is within tolerance) moved to where they fit.
#pragma once

#include <Eigen/Dense>

#include "arms/replay/replay.h"
#include "arms/search/noise.h"

namespace flextip::arms {

/// Fits nuisances alone, from where the replay is.
void FitNuisances(Replay& replay, const Noise& noise, int rounds = 4);

/// Returns the parameters with those that are each recording's own (a tracker's place) moved one
/// step to where they fit, about where the replay is.
Eigen::VectorXd FitOwn(const Replay& replay, const Noise& noise);

}  // namespace flextip::arms
