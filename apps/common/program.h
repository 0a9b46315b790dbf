// A program of commands: what flextip and the demo's program share.
#pragma once

#include <string>
#include <vector>

#include "apps/common/commands.h"

namespace flextip {

struct ProgramText {
  std::string name;         ///< as it is typed
  std::string description;  ///< one line
  std::string footer;       ///< the last lines of its help
};

/// Runs the program: `add_commands` gives it its commands, `typed` are its arguments without its
/// name. Returns the exit code of ExitCodeOf; the reason of a failure goes to stderr.
int RunProgram(const ProgramText& text, void (*add_commands)(CLI::App&, AppContext&),
               const std::vector<std::string>& typed);

}  // namespace flextip
