// Paths in space, drawn flat.
#pragma once

#include "report/drawing/plot.h"

namespace flextip::report {

/// Draws the traces of a figure in space as seen from the corner that a page begins with, parallel
/// and to scale, in a box with ticks.
void DrawSpace(const Figure& figure, const PlotArea& area, Canvas& canvas);

}  // namespace flextip::report
