// Where the wrist and the tip of the planar robot can be (Fig. 2.3).
#pragma once

#include <vector>

#include "workspace/planar_instrument.h"

namespace flextip {

/// The wrist's workspace by the joint limits alone: its boundary, closed, in (z, y), points at most
/// about `spacing_m` apart.
std::vector<Eigen::Vector2d> WristOutline(const PlanarArm& arm, double spacing_m);

/// The tip's workspace: the boundary of what the wrists that reach the port give, closed.
std::vector<Eigen::Vector2d> TipOutline(const PlanarInstrument& instrument, double spacing_m);

/// Wrist positions on a grid, within the joint limits.
struct WristPositions {
  double spacing_m = 0.0;
  std::vector<Eigen::Vector2d> reaching = {},
                               not_reaching = {};  ///< by whether the shaft gets to the port
};
WristPositions FindWristPositions(const PlanarInstrument& instrument, double spacing_m);

}  // namespace flextip
