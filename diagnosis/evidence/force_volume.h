// How much noise unknown tip forces take up. The more a sensor feels a force, the more of its noise
// the force explains, and the squared residual falls without anything being explained: by as much
// as rows are taken up (the trace that Mallows's C_p is made of), which is put back on it here.
// Without it a yielding tip would look likely only because the least known force, that along the
// shaft, could then explain the tip's noise. It is taken for the compliances, which scale what a
// force does, against the same model without them.
//
// Nothing for a known load: its noise enters all hypotheses alike (Replay::FixNoiseModel).
#pragma once

#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {

/// To be put back on the squared residual: rows taken up in all samples (from a few of them) by the
/// compliances, times the variance of the noise that is there, `squares` over the rows that are
/// left of `rows`. Data sheets say rather too much of it; more than stated is not noise.
double ForceVolume(const Replay& replay, double squares, double rows);

}  // namespace flextip::diagnosis
