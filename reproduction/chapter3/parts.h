// The parts of chapter 3. Private to reproduction.
#pragma once

#include "reproduction/chapter.h"

namespace flextip::reproduction {

/// The straight shaft on a bent one, without noise (3.4.1, Fig. 3.5), and the beam itself on the
/// exact rod.
ChapterResult Ch3Straight(const ReproduceOptions& options, const ChapterProgress& progress);
/// The flexion Jacobian and its estimates under noise (3.4.2, Figs. 3.6 to 3.9).
ChapterResult Ch3Sensitivity(const ReproduceOptions& options, const ChapterProgress& progress);
/// The text's numbers for an electromagnetic tracker (3.5).
ChapterResult Ch3Tracker(const ReproduceOptions& options, const ChapterProgress& progress);
/// Orientation control (end of 3.5): what three axes of the wrist can do for the tip's direction.
ChapterResult Ch3Direction(const ReproduceOptions& options, const ChapterProgress& progress);

}  // namespace flextip::reproduction
