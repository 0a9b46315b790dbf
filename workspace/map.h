// The measures over a grid of tip positions.
#pragma once

#include <vector>

#include "workspace/measures.h"

namespace flextip {

/// A plane through A's axes in which a map lies. In the plane (N = 2) there is one: z to the right,
/// y up.
template <int N>
struct Slice {
  int right = N == 2 ? 0 : 2, up = 1;  ///< the axes of A, as components of VectorN<N>
  double offset_m = 0.0;               ///< along the third axis (N = 3)

  VectorN<N> Point(double right_m, double up_m) const;
  Eigen::Vector2d InPlane(const VectorN<N>& p) const { return {p[right], p[up]}; }
};

template <int N>
struct WorkspaceMap {
  Slice<N> slice;
  double spacing_m = 0.0;
  std::vector<double> right_m = {}, up_m = {};  ///< the grid's lines, multiples of the spacing
  std::vector<PointMeasures<N>> points = {};    ///< up_m.size() rows of right_m.size()

  const PointMeasures<N>& At(std::size_t row, std::size_t column) const {
    return points[row * right_m.size() + column];
  }
  /// Returns the number of points that the tip can reach.
  std::size_t Reached() const;
};

/// Maps all of the tip's workspace in the slice, without the empty rows and columns around it. Uses
/// all cores.
template <int N>
WorkspaceMap<N> ComputeMap(const MapSetup<N>& setup, const Slice<N>& slice, double spacing_m);

/// Returns the rows and columns of the map within `margin_m` of any of the places.
template <int N>
WorkspaceMap<N> PartAround(const WorkspaceMap<N>& map, const std::vector<Eigen::Vector2d>& places,
                           double margin_m);

extern template struct Slice<2>;
extern template struct Slice<3>;
extern template struct WorkspaceMap<2>;
extern template struct WorkspaceMap<3>;

}  // namespace flextip
