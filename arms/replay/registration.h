// A tracker and a marker whose places are unknown, from poses and the arm's own (Tsai & Lenz 1989's
// problem A X = Z B, both rotations at once by the smallest eigenvector).
#pragma once

#include <optional>
#include <vector>

#include "core/pose.h"

namespace flextip::arms {

struct Places {
  Pose T_TR, T_LK;
};

/// `arm[k]` is T_RL, `seen[k]` T_TK. With `marker` unknown both are found, else T_TR alone for
/// T_LK as given. Empty where the motion does not tell (fewer than three poses, no rotation).
std::optional<Places> FindPlaces(const std::vector<Pose>& arm, const std::vector<Pose>& seen,
                                 bool marker_unknown, const Pose& T_LK);

/// The same without orientations: T_TR alone, from points.
std::optional<Pose> FindTracker(const std::vector<Eigen::Vector3d>& arm,
                                const std::vector<Eigen::Vector3d>& seen);

}  // namespace flextip::arms
