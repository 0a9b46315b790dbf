// Maps of the measures as figures of a page.
#pragma once

#include <string>
#include <vector>

#include "report/figure.h"
#include "workspace/map.h"

namespace flextip {

/// What is drawn of every point, in the units of the figures.
enum class MapQuantity {
  kNorm,    ///< ||G||
  kPhiHat,  ///< degrees
  kPhiMax,  ///< degrees
};

/// One value a point of the map, NaN where there is none, to five digits.
template <int N>
std::vector<double> ValuesOf(const WorkspaceMap<N>& map, MapQuantity quantity);

/// The values over the map's grid in mm, with the contour lines and colours of the quantity.
template <int N>
report::Figure MapFigure(const WorkspaceMap<N>& map, MapQuantity quantity,
                         const std::vector<double>& values);
template <int N>
report::Figure MapFigure(const WorkspaceMap<N>& map, MapQuantity quantity) {
  return MapFigure(map, quantity, ValuesOf(map, quantity));
}

enum class MapDirection { kVSigma, kPPhi };

/// Short lines along the directions on a grid `every_m` apart; `scaled`: as long as ||G|| or
/// |phi_max| is large, up to a longest. Directions out of the slice are shortened.
template <int N>
report::Figure DirectionFigure(const WorkspaceMap<N>& map, MapDirection direction, bool scaled,
                               double every_m);

/// The true port (circle) and the believed one (x).
template <int N>
void MarkPorts(report::Figure& figure, const MapSetup<N>& setup, const Slice<N>& slice);

/// Points of a plane (m) as a trace in mm.
report::FigureTrace TraceInMm(const std::vector<Eigen::Vector2d>& points_m,
                              report::FigureTrace style);

double ToDigits(double value, int digits = 5);

}  // namespace flextip
