// Recordings made wrong in known ways, without the library's own code.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace flextip {

using BreakRng = std::mt19937_64;

struct BrokenWay {
  std::string name;
  std::string finding;     ///< the id that names it rightly
  bool hung_mass = false;  ///< shows only with a mass hung on the tip
  std::function<void(Recording&, BreakRng&)> make;
};

/// Returns all ways.
const std::vector<BrokenWay>& BrokenWays();

/// Returns a copy of `recording` made wrong.
Recording BreakRecording(const Recording& recording, const BrokenWay& way, BreakRng& rng);

/// Adds em1, command0 and tags0 to a hidden recording, as they would be.
void AddFurtherStreams(Recording& recording, BreakRng& rng);

}  // namespace flextip
