// Whether an effect outside the catalogue could be told at all from what the catalogue holds.
#pragma once

#include "bench/diagnosis_matrix/rival.h"
#include "recording/recording.h"
#include "testdata/hidden/recording.h"

namespace flextip::bench {

/// `with` is the recording made with `options` and `seed` at the draw `attempt`. Its signal is what
/// changes when the same is made without the effects named there: same scene, tolerances and noise.
/// The rival's name is empty where that cannot be had (another draw, no equilibrium, other readings
/// left out).
Separation MeasureForm(const Recording& with, int attempt, hidden::HiddenOptions options,
                       std::uint64_t seed);

}  // namespace flextip::bench
