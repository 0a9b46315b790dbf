// What is hidden in an arm that moves by forces in time.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "simulation/joints/arm_recording.h"

namespace flextip::bench {

/// One arm to be diagnosed.
struct ArmCase {
  std::string part;  ///< "single", "pair", "healthy", "deleted", "form"
  int number = 0;
  std::uint64_t first_seed = 1;

  std::string Name() const { return part + " " + std::to_string(number); }
};

/// What is in it.
struct HiddenArm {
  std::set<std::string> effects;  ///< as docs/effects.md names them
  std::string size;               ///< "subtle", "plain", "strong"; empty: nothing is hidden
  std::string sensors;
  simulation::ArmFaults faults;
  simulation::ArmSensors streams;
  simulation::ArmMotion motion;
  double eccentric_rad = 0.0;  ///< of a form that no effect has: a gear off its centre at joint 1
};

/// Returns the same for the same case. Sizes are 6, 18 and 54 tolerances; sensors are some that can
/// show the effects.
HiddenArm Draw(const ArmCase& one);

/// Returns the recording, without a word of what is in it.
Recording RecordingOf(const HiddenArm& hidden);

}  // namespace flextip::bench
