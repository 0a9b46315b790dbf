// What differs between healthy recordings of several labs.
#pragma once

#include <random>
#include <string>

#include "recording/recording.h"

namespace flextip::bench {

/// Draws another frame R, other rates, stamps that jitter and come late, streams that begin and end
/// at their own times, dropped samples, lost tips, another origin of time, signs of quaternions,
/// and rounded numbers. Returns the draw in words.
std::string Vary(Recording& recording, std::mt19937_64& rng);

}  // namespace flextip::bench
