// Corners where four squares meet, to a fraction of a pixel.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "core/image.h"

namespace flextip {

/// How far from a corner its own edges alone are seen, in distances to the next corner: a larger
/// window reaches into the neighbours' edges where the board is tilted, and is pulled by them.
inline constexpr double kSaddleReach = 0.33;

/// Moves each of `px` to the saddle of the grey values near it, seen through a window of
/// `reach_px` to each side (between 2 and 40 pixels).
void RefineSaddles(const Image& grey, double reach_px, std::vector<Eigen::Vector2d>& px);

}  // namespace flextip
