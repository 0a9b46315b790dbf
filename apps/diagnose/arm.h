// What `diagnose` does where the recordings are an arm's: reads them, makes the arm's diagnosis and
// writes its files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flextip {

struct ArmRun {
  std::vector<std::filesystem::path> recordings;
  std::filesystem::path out;
  std::vector<std::string> without;
  bool force = false, quiet = false;
  bool closed_loop = true;  ///< measure the gain on a simulated arm, too
};

/// Whether a recording holds an arm's joints (joints0, or joints_command0 with joints_seen0) and no
/// shaft with sensors of its own.
bool IsArmRecording(const std::filesystem::path& recording);

void DiagnoseArm(const ArmRun& run);

/// What `predict` does with an arm's model. Throws InputError where the recording is no arm's.
void PredictArm(const ArmRun& run, const std::filesystem::path& model);

}  // namespace flextip
