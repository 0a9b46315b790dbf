// The parts of chapter 4. Private to reproduction.
#pragma once

#include <array>
#include <vector>

#include "core/mean_sd.h"
#include "reproduction/chapter.h"
#include "reproduction/chapter4/steps.h"

namespace flextip::reproduction {

/// The simulation of 4.3.1, by the beam itself and by the exact plant (Fig. 4.2).
ChapterResult Ch4Simulation(const ReproduceOptions& options, const ChapterProgress& progress);
/// The first set of experiments: a mass hung on the shaft, the joints settled before each update
/// (Fig. 4.3).
ChapterResult Ch4Experiment(const ReproduceOptions& options, const ChapterProgress& progress);
/// Indentation of a silicone block by an arm with inertia (Fig. 4.4).
ChapterResult Ch4Indentation(const ReproduceOptions& options, const ChapterProgress& progress);

/// The rod of chapter 4: 600 mm of 2.38 mm steel (E = 193 GPa), weightless.
Instrument Ch4Rod();
/// The four moves, in the order +x, -x, +y, -y.
extern const std::array<Eigen::Vector3d, 4> kCh4Moves;
/// Points of a path, from its start (mm).
report::FigureTrace PathTrace(const std::vector<Eigen::Vector3d>& path,
                              const Eigen::Vector3d& origin);

}  // namespace flextip::reproduction
