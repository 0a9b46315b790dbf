// How far the shaft is bent: as sensors see it, and as forces make it.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "plausibility/scene.h"

namespace flextip::plausibility {

/// Returns the turn (rad) of the shaft from the wrist to its far end about the wrist's y and z, by
/// the directions of em0 or the tip. Empty where one is not known.
std::optional<Eigen::Vector2d> TurnSeen(const Scene& scene, const Instant& now);
/// Returns the same turn as the moments of strain0 make it: straight lines of moment from the
/// pinned wrist to the port and from there to the tip.
std::optional<Eigen::Vector2d> TurnByMoments(const Scene& scene, const Instant& now);

/// Returns the moments (Nm) at the second station about y and z, as the force on the tip makes
/// them.
std::optional<Eigen::Vector2d> MomentByLoad(const Scene& scene, const Instant& now);

/// Returns how far the tip lies beside the straight shaft (m, in R), as seen.
std::optional<Eigen::Vector3d> DeflectionSeen(const Scene& scene, const Instant& now);
/// Returns how far the force on the tip bends it beside the straight shaft (m, in R).
std::optional<Eigen::Vector3d> DeflectionByLoad(const Scene& scene, const Instant& now);

}  // namespace flextip::plausibility
