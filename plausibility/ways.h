// Ways to be wrong, each with what undoes it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "plausibility/scene.h"

namespace flextip::plausibility {

struct Way {
  std::string id;      ///< "em0.unit"
  std::string stream;  ///< "em0", "port", "length": what it repairs
  std::string looks;   ///< "em0: positions look like millimetres"
  std::string mend;
  bool searched = false;  ///< values of its own were fitted: others go first
  std::function<void(Scene&)> undo;
};

/// Returns the ways that the streams of a recording can be wrong.
std::vector<Way> WaysFor(const Scene& scene);

/// Returns the ways with values that the scene tells: where the port is, how long the shaft is.
std::vector<Way> SearchedWaysFor(const Scene& scene);

}  // namespace flextip::plausibility
