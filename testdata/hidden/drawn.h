// What a hidden recording is made of, drawn from its seed.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "simulation/plant/effects.h"
#include "testdata/hidden/forms.h"
#include "testdata/hidden/recording.h"

namespace flextip::hidden {

struct DrawnCase {
  HiddenScene scene;
  HiddenLabel label;
  simulation::PlantEffects plant;
  std::vector<HiddenForm> forms;
  int attempt = 0;
};

/// One generator for each purpose, from seed and attempt.
std::mt19937_64 GeneratorFor(std::uint64_t seed, int attempt, int purpose);

DrawnCase DrawCase(const HiddenOptions& options, std::uint64_t seed, int attempt);

/// Recording `index` of a series whose first one is `first`: everything the same but motion, load,
/// roll, phases, and the effects that have begun. `motion` counts draws of the motion.
DrawnCase DrawNextCase(const HiddenSeries& series, std::uint64_t seed, const DrawnCase& first,
                       int index, int motion);

}  // namespace flextip::hidden
