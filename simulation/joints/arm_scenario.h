// A scenario of an arm with joints: its file, a motion, its sensors, and what its file does not
// say.
#pragma once

#include <filesystem>

#include "recording/read_log.h"
#include "simulation/joints/arm_recording.h"

namespace flextip::simulation {

struct ArmScenario {
  Arm arm;
  ArmFaults faults;
  ArmSensors sensors;
  ArmMotion motion;
};

/// Returns whether a scenario is of an arm: it has a key `arm`. Throws InputError for a file that
/// is no YAML.
bool IsArmScenario(const std::filesystem::path& file);

/// Throws InputError with file and line for keys that are missing, unknown or of the wrong kind,
/// for values out of range, and for an arm whose file states no masses (the keys are in
/// docs/scenarios.md).
ArmScenario ReadArmScenario(const std::filesystem::path& file, ReadLog& log);

}  // namespace flextip::simulation
