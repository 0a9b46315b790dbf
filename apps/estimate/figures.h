// Figures of the estimates: the shaft where it bends most, the force over time.
#pragma once

#include <vector>

#include "estimation/shaft_estimator.h"
#include "recording/recording.h"
#include "report/figure.h"

namespace flextip {

/// Returns the figures, each with two standard deviations; none where nothing was estimated.
std::vector<report::Figure> EstimateFigures(const Recording& recording,
                                            const Series<ShaftEstimate>& estimates);

}  // namespace flextip
