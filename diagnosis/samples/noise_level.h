// How much noise there really is, from differences of neighbouring residuals: what a slow misfit
// leaves untouched.
#pragma once

#include <array>
#include <vector>

#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {

/// Factors on the data sheets' standard deviations, at least one, by channel: noise that is larger,
/// and noise that remembers (AR(1) with coefficient phi), which tells a slow pattern from chance as
/// noise sqrt((1 + phi) / (1 - phi)) times as large would.
std::array<double, kChannelCount> NoiseScale(const Replay& replay);

/// Samples that are far from what the replay explains, where these are few: a tip that snaps from
/// one equilibrium to another between two readings, a value that no filter saw. None where they are
/// many: then it is the model.
std::vector<std::size_t> FarSamples(const Replay& replay);

/// Returns the median over the samples of the root mean square of a sample's whitened rows.
double MedianMisfit(const Replay& replay);

}  // namespace flextip::diagnosis
