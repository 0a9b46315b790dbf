// Refines a tag's corners: the intersections of edges that are fitted to the grey values.
#pragma once

#include <Eigen/Dense>
#include <array>

#include "core/image.h"

namespace flextip {

struct RefinedQuad {
  std::array<Eigen::Vector2d, 4> corners_px;
  int edges_fitted = 0;  ///< of 4; an edge that could not be fitted stays where it was
};

/// Fits each edge of the quadrilateral `corners_px` (pixel (0,0) is a pixel's centre) to the grey
/// values around it, by least squares. The edge's model is a step between two levels that may vary
/// along the edge, blurred by a Gaussian. `cells_across` is the number of tag cells between
/// opposite edges: only values nearer to the edge than the next cell are used.
RefinedQuad RefineCorners(const Image& grey, const std::array<Eigen::Vector2d, 4>& corners_px,
                          int cells_across);

}  // namespace flextip
