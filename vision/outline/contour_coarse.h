// Where a tube's outline has gone since it was predicted, by a vote of all scan lines.
#pragma once

#include <optional>
#include <vector>

#include "vision/outline/contour_edge.h"
#include "vision/outline/tube_geometry.h"

namespace flextip {

/// The shift of the outline, outward, at each point of `points` (px, whole).
struct CoarseShift {
  std::vector<double> outward_px;
  bool ambiguous = false;  ///< another place has nearly as many votes
};

/// Finds the shift of both sides together: aside by a straight line a + b `place`, |a| and |b| up
/// to `search_px`. The place with the most evidence wins. Points of the end get their part of that
/// (0). Empty with fewer than six lines in the picture.
std::optional<CoarseShift> ShiftAside(const ScanEdgeFinder& finder, const Image& grey,
                                      const std::vector<ContourPoint>& points, int search_px);

/// Finds the shift of the end alone, along the tube; the sides get 0.
std::optional<CoarseShift> ShiftAlong(const ScanEdgeFinder& finder, const Image& grey,
                                      const std::vector<ContourPoint>& points, int search_px);

}  // namespace flextip
