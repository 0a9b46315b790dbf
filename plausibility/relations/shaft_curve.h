// The bent shaft between two of its places.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "plausibility/scene.h"

namespace flextip::plausibility {

/// A cubic with the shaft's measured directions at both ends, as points (m, in R).
struct ShaftCurve {
  std::vector<Eigen::Vector3d> points;
  double length_m = 0.0;

  /// Returns the point of the curve that is nearest to `p`, and in `along` the curve's direction
  /// there (unit).
  Eigen::Vector3d Nearest(const Eigen::Vector3d& p, Eigen::Vector3d* along = nullptr) const;
};

/// Returns the curve from begin to end. Directions are unit; `length_m` is the shaft's length
/// between both.
ShaftCurve CurveBetween(const Eigen::Vector3d& p_begin, const Eigen::Vector3d& d_begin,
                        const Eigen::Vector3d& p_end, const Eigen::Vector3d& d_end,
                        double length_m);

/// Returns the curve from the wrist to em0; empty where a direction is missing.
std::optional<ShaftCurve> CurveToEm(const Scene& scene, const Instant& now);
/// Returns the curve from the wrist to the tip; empty where a direction is missing.
std::optional<ShaftCurve> CurveToTip(const Scene& scene, const Instant& now);

/// Returns the straight shaft's direction from wrist to port (unit); empty where both coincide.
std::optional<Eigen::Vector3d> DirectionToPort(const Scene& scene, const Instant& now);
/// Returns the x axis of an orientation: the shaft's direction at a sensor.
Eigen::Vector3d ShaftAxis(const Eigen::Quaterniond& q);

}  // namespace flextip::plausibility
