// The parts of chapter 2. Private to reproduction.
#pragma once

#include "reproduction/chapter.h"

namespace flextip::reproduction {

/// Maps of the measures over the two-link arm's workspace and the text's statements about them
/// (2.3.1, Figs. 2.3 to 2.6).
ChapterResult Ch2Maps(const ReproduceOptions& options, const ChapterProgress& progress);
/// Moves from L, M and N to eight goals each (2.3.2, Fig. 2.8): by quasi-static steps, and by an
/// arm with dynamics, PID and friction at the port.
ChapterResult Ch2Trajectories(const ReproduceOptions& options, const ChapterProgress& progress);

}  // namespace flextip::reproduction
