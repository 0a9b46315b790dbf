// What `control` does with a folder in place of a session: desired joints of an arm become commands
// that bring its true joints there, by the model that `diagnose` found. No robot moves.
#pragma once

#include <filesystem>

#include "arms/data/arm_data.h"
#include "recording/recording.h"

namespace flextip {

/// Joints as rows from time 0.
arms::Track TrackOfJoints(const JointStream& stream);

/// Throws InputError where a recording has no desired joints of an arm.
void RequireDesiredJoints(const Recording& wish, const std::filesystem::path& file);

struct JointCommandsRun {
  std::filesystem::path wish;   ///< recording whose joints_command0 are the desired joints
  std::filesystem::path model;  ///< of an arm
  std::filesystem::path out;
  bool force = false, quiet = false;
};

/// Writes the recording `out` whose joints_command0 are the commands, with the same times. Throws
/// InputError where there are no desired joints, and for a model of something else.
void WriteJointCommands(const JointCommandsRun& run);

}  // namespace flextip
