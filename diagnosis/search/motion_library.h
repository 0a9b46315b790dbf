// Motions that a user could make to tell effects apart: imagined recordings with the sensors of a
// real one.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/samples/sample_set.h"

namespace flextip::diagnosis {

struct ImaginedMotion {
  std::string text;   ///< what to do, for a person
  SampleSet samples;  ///< measured values mean nothing, only which of them there are
};

/// Some thirty motions about the port of `recorded`, 20 s each: insertions, sweeps, circles, slow
/// and fast, with and without a mass hung from the tip or a roll of the instrument.
std::vector<ImaginedMotion> MotionLibrary(const SampleSet& recorded);

}  // namespace flextip::diagnosis
