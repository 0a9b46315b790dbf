// A picture of one shape: side view (x, z) and top view (x, y), in mm.
#pragma once

#include <filesystem>
#include <string>

#include "kinematics/shaft_shape.h"

namespace flextip {

/// A PNG file's bytes. `shape` must be usable.
std::string DrawShape(const RodProblem& problem, const Shape& shape);

}  // namespace flextip
