// The Jacobian of the bent shaft as chapter 3 prints it, mistakes and all (docs/errata.md): what
// chapters 3 and 4 used. Private to reproduction.
#pragma once

#include <Eigen/Dense>

namespace flextip::reproduction {

/// (3.15)-(3.26): d tip / d wrist in the plane, from the port `a` along the chord and `y_a` beside
/// it, `phi` of (3.9), and the port as seen from the wrist (m, rad).
Eigen::Matrix2d PrintedPlaneJacobian(double a, double y_a, double length_m, double phi,
                                     const Eigen::Vector2d& wrist_to_port);

}  // namespace flextip::reproduction
