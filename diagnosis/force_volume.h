// How much of the data unknown tip forces take up. The more a sensor feels a force, the more the
// force can explain, and evidence falls with the log determinant of each sample's covariance.
// Without it a yielding tip would look likely only because the least known force, that along the
// shaft, could then explain the tip's noise. It is taken for the compliances, which scale what a
// force does, against the same model without them. Known loads take up nothing.
#pragma once

#include "diagnosis/linear_problem.h"

namespace flextip {

/// Sum over the samples (every so many of them) of the log determinant.
double ForceVolume(const Replay& replay);

/// Sets the problem's volume: value and slope.
void AddForceVolume(const Replay& replay, LinearProblem& problem);

}  // namespace flextip
