// Healthy recordings of other scenes, sensors, rates, noises and effects than the tests have.
#pragma once

#include <cstdint>
#include <string>

#include "recording/recording.h"

namespace flextip::bench {

struct HealthyCase {
  std::string name;  ///< what was drawn, for people
  Recording recording;
  bool hung_mass = false;
};

/// Draws an open-loop motion with hidden effects, then varies it (vary.h).
HealthyCase DrawOpenLoop(std::uint64_t seed);
/// Draws a controller's run of one of the scenarios in `testdata/scenarios`, then varies it.
HealthyCase DrawClosedLoop(std::uint64_t seed);
/// Draws every fourth case in closed loop, the others in open loop.
HealthyCase DrawHealthy(std::uint64_t seed);

}  // namespace flextip::bench
