// At which frequency the port moves, if it moves: the screen's only unknown that the model is not
// linear in.
#pragma once

#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {

/// The breathing frequency (Hz) whose sine and cosine in the port's position explain most of what
/// the parameters within their tolerances do not.
double BestPortFrequency(const Replay& replay);

}  // namespace flextip::diagnosis
