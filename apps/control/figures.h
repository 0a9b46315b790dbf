// The times of a control run, drawn.
#pragma once

#include <vector>

#include "live/loop/control_loop.h"
#include "report/figure.h"

namespace flextip {

/// Returns how often each duration of a cycle occurred: late at its begin, from there to the
/// command sent, and from the wrist's sample to the command sent.
std::vector<report::Figure> TimeFigures(const live::LoopReport& report);

}  // namespace flextip
