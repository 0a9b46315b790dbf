// Faults of an arm of three joints by the effects that they are.
#pragma once

#include <random>
#include <string>

#include "simulation/joints/arm_recording.h"

namespace flextip::hidden {

/// Puts an effect of so many tolerances in, of a SmallArm(): which joint and sign are drawn. Throws
/// InputError for an effect that no fault is.
void PutFault(const std::string& effect, double tolerances, std::mt19937_64& rng,
              simulation::ArmFaults& faults);

}  // namespace flextip::hidden
