// The table of equilibria: its input columns are problems, its other columns are shapes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kinematics/shaft_shape.h"

namespace flextip {

/// Reads the input columns by their names, in any order among others. Throws InputError with file
/// and line for missing columns, numbers that are not finite and lines that are not whole.
std::vector<RodProblem> ReadShapeProblems(const std::filesystem::path& file);

/// The table with every column and `status`, as text; a shape that is not usable has its status and
/// empty cells. Numbers read back bit for bit.
std::string ShapeTable(const std::vector<RodProblem>& problems, const std::vector<Shape>& shapes);

/// The same columns as one JSON object, vectors as lists.
std::string ShapeJson(const RodProblem& problem, const Shape& shape);

}  // namespace flextip
