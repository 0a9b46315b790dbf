// Where a board's corners truly are: prints are scaled and sheets are bent.
#pragma once

#include <map>
#include <optional>

#include "calibration/camera/camera_solution.h"

namespace flextip {

/// By corner id, how far the true corner is from where the board's description has it, in B (m).
using BoardShape = std::map<int, Eigen::Vector3d>;

/// Adjusts lens, poses and warp with every corner's place on the board in turn, each place held to
/// the description by a standard deviation of `sd_m` (which also keeps the board's size), until
/// neither moves (Strobl and Hirzinger 2008 free the corners in the same way). The views' `x_B` are
/// moved with it. `solution.noise_px` then counts the corners' coordinates among the parameters;
/// `solution.normal_matrix` holds the shape as known. Empty where an adjustment fails.
std::optional<BoardShape> AdjustBoardShape(CameraSolution& solution, double sd_m);

/// Moves the corners of a view that has not been moved yet.
void MoveCorners(const BoardShape& shape, SolvedView& view);

/// The root of the mean squared length of the offsets (m), and the longest.
std::pair<double, double> SizeOf(const BoardShape& shape);

}  // namespace flextip
