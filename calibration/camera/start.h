// Where bundle adjustment starts, such that it does not end in a wrong minimum.
#pragma once

#include <optional>
#include <vector>

#include "calibration/camera/solution.h"

namespace flextip {

/// A lens of few terms (opencv with 5, or equidistant), the board's poses and no warp, near the
/// best minimum for the corners of `views` (their `ids`, `x_B`, `px`): bundle adjustment from
/// several focal lengths (that of the vanishing points among them), first with two radial terms and
/// the principal point in the picture's middle, robustly, the best ones with all terms; then both
/// planar poses of each view are tried. A view whose corners no pose explains is left out (`index`
/// tells which are there). Empty where no start leads anywhere.
std::optional<CameraSolution> StartSolution(const std::vector<SolvedView>& views, int width_px,
                                            int height_px, bool equidistant);

/// The focal length (px) under which the vanishing points of the boards' sides are at right angles
/// in the mean, for square pixels without distortion and a principal point `centre_px` (Zhang
/// 2000). Empty where the views do not tell: boards that all face the camera.
std::optional<double> FocalOfVanishingPoints(const std::vector<SolvedView>& views,
                                             const Eigen::Vector2d& centre_px);

/// Fits each view's pose alone, from where it is and from its mirror image about the line of sight,
/// and keeps the better one. The lens stays.
void TryMirroredPoses(CameraSolution& solution, double cauchy_px);

}  // namespace flextip
