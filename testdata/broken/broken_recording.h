// Recordings made wrong in known ways, without the code of plausibility/.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace flextip::broken {

using Rng = std::mt19937_64;

struct BrokenWay {
  std::string name;
  std::string finding;             ///< the id that names it rightly
  std::vector<std::string> needs;  ///< streams without which it cannot be seen; "hung mass" a load
  std::function<void(Recording&, Rng&)> make;
};

/// Returns all ways.
const std::vector<BrokenWay>& BrokenWays();

/// Returns whether `recording` has all that `way` needs; `hung_mass`: a mass hangs on its tip.
bool Applies(const BrokenWay& way, const Recording& recording, bool hung_mass);

/// Returns a copy of `recording` made wrong.
Recording BreakRecording(const Recording& recording, const BrokenWay& way, Rng& rng);

/// Adds em1, command0 and tags0 to a recording, as they would be.
void AddFurtherStreams(Recording& recording, Rng& rng);

}  // namespace flextip::broken
