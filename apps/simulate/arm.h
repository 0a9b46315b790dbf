// flextip simulate of an arm with joints: a motion by forces in time, written as a recording.
#pragma once

#include <filesystem>

namespace flextip {

struct ArmCommand {
  std::filesystem::path scenario, out;
  bool force = false;
};

/// Throws as ReadArmScenario, and WorkError where the plant does not stay finite.
void SimulateArm(const ArmCommand& command, bool quiet);

}  // namespace flextip
