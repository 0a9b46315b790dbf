// The data that a reader had to carry on without.
#pragma once

#include <string>
#include <vector>

namespace flextip {

struct ReadLog {
  std::vector<std::string> warnings;  ///< one line each
  long torn_lines = 0;                ///< last lines of a crashed recorder, skipped
  long dropped_frames = 0;            ///< frames the camera or its recorder left out
};

}  // namespace flextip
