// The parts of chapter 5. Private to reproduction.
#pragma once

#include "reproduction/chapter.h"

namespace flextip::reproduction {

/// The user study with simulated operators (5.2.6, 5.2.7, 5.3), and beyond it: vision as the tip's
/// sensor, the tissue's response in the model.
ChapterResult Ch5Operators(const ReproduceOptions& options, const ChapterProgress& progress);
/// Which sensors supply the model: sensor set by controller, over one sample and over a window.
ChapterResult Ch5Sensors(const ReproduceOptions& options, const ChapterProgress& progress);

}  // namespace flextip::reproduction
