// The real paths in a command to copy, which libraries write with placeholders.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace flextip {

struct CommandPaths {
  std::filesystem::path recording = {};                  ///< RECORDING
  std::filesystem::path picture = {};                    ///< PICTURE
  std::filesystem::path result = {};                     ///< RESULT: the folder of the results
  std::filesystem::path tracked = {};                    ///< with which the recording was read
  std::vector<std::filesystem::path> calibrations = {};  ///< the same
  std::filesystem::path model = {};                      ///< MODEL

  /// Returns `command` ("flextip estimate RECORDING -o RESULT-estimate") with the paths, quoted
  /// where a shell needs it. A command that reads the recording as this one did gets --tracked and
  /// --calibration, too.
  std::string Fill(const std::string& command) const;
};

}  // namespace flextip
