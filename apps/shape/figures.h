// Figures of one shape: side view (x, z) and top view (x, y), in mm.
#pragma once

#include <vector>

#include "kinematics/shaft_shape.h"
#include "report/figure.h"

namespace flextip {

/// `shape` must be usable.
std::vector<report::Figure> ShapeFigures(const RodProblem& problem, const Shape& shape);

}  // namespace flextip
