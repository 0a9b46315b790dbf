// Ways for a recording to be wrong, each with the change that undoes it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "plausibility/scene.h"

namespace flextip::plausibility {

struct Fault {
  std::string id;       ///< "em0.unit"
  std::string subject;  ///< "em0", "port", "length": the subject of the relations that it repairs
  std::string looks;    ///< "em0: positions look like millimetres"
  std::string mend;     ///< the line that mends it
  std::function<void(Scene&)> undo;
  double clock_shift_s = 0.0;  ///< of a clock: seconds to add to the subject's stamps
};

/// Returns the faults that the streams and settings of a scene can have.
std::vector<Fault> FaultsOf(const Scene& scene);

/// Returns the faults whose mend is a value that the scene tells: where the port is, how long the
/// shaft is.
std::vector<Fault> SearchedFaultsOf(const Scene& scene);

}  // namespace flextip::plausibility
