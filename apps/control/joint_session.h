// `control` with a session of joints, and its replay.
#pragma once

#include <filesystem>
#include <optional>

namespace flextip {

struct JointSessionRun {
  std::filesystem::path session, out;
  std::optional<double> duration_s;
  bool wait = false, force = false, quiet = false;
};

/// Moves the robot along the desired joints, and writes the recording of it when it is over.
void ControlJoints(const JointSessionRun& run);

/// Whether a recording is of such a run.
bool HasJointCycles(const std::filesystem::path& recording);

struct JointReplay {
  long cycles = 0, differ = 0;
};
/// Runs every recorded cycle again on its recorded inputs, and compares the outputs bit for bit.
JointReplay ReplayJointCycles(const std::filesystem::path& recording);

}  // namespace flextip
