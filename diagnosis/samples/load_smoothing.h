// The noise of a measured load, told from the load by the samples around.
#pragma once

#include "diagnosis/samples/sample_set.h"

namespace flextip::diagnosis {

/// Smooths f_tip_N and sets force_noise_N and f_around_N of all samples, whose f_tip_N is as read
/// (N) with set.noise.force_N. Sensors that speak late look back at other samples' loads: noise
/// must not differ from one to the next.
void SmoothLoad(SampleSet& set);

}  // namespace flextip::diagnosis
