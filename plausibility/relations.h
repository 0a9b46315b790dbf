// What streams say of one another: each relation is a misfit, 1 at the limit of what a bent shaft,
// a registration or a latency can make of it.
#pragma once

#include <string>
#include <vector>

#include "plausibility/scene.h"

namespace flextip::plausibility {

struct Relation {
  std::string name;                  ///< "em0.place"
  std::vector<std::string> streams;  ///< that it compares, also "port", "length", "stiffness"
  double misfit = 0.0;
  std::string text;  ///< of the misfit: "em0 is 241 m from where ..., 0.19 m would be plausible"

  bool Violated() const { return misfit > 1.0; }
  bool Names(const std::string& stream) const;
};

/// Returns every relation that the scene's streams allow. Streams that are never there at the same
/// time as the wrist have one of misfit 3.
std::vector<Relation> RelationsOf(const Scene& scene);

/// Returns one number for all: the sum of the squares, each limited.
double TotalMisfit(const std::vector<Relation>& relations);
/// Returns whether any is violated.
bool AnyViolated(const std::vector<Relation>& relations);
/// Returns the violated relation with the largest misfit that names `stream` (any where empty), or
/// null.
const Relation* WorstOf(const std::vector<Relation>& relations, const std::string& stream = "");

/// The bent shaft from the wrist to a sensor: a cubic with the measured directions at both ends.
struct ShaftCurve {
  std::vector<Eigen::Vector3d> points;
  double length_m = 0.0;

  /// Returns the point of the curve that is nearest to `p`, and in `along` the curve's direction
  /// there.
  Eigen::Vector3d Nearest(const Eigen::Vector3d& p, Eigen::Vector3d* along = nullptr) const;
};
/// Directions are unit; `length_m` is the length that the shaft has between both.
ShaftCurve CurveBetween(const Eigen::Vector3d& p_begin, const Eigen::Vector3d& d_begin,
                        const Eigen::Vector3d& p_end, const Eigen::Vector3d& d_end,
                        double length_m);
/// Returns the curve from the wrist to em0 or the tip at an instant; empty where a direction is
/// missing.
std::optional<ShaftCurve> CurveToEm(const Scene& scene, const Instant& now);
std::optional<ShaftCurve> CurveToTip(const Scene& scene, const Instant& now);

/// Returns the turn (rad) of the shaft between wrist and em0 (or the tip) about the wrist's y and
/// z: as seen from the directions, and as the moments of strain0 make it. Empty where not known.
std::optional<Eigen::Vector2d> TurnSeen(const Scene& scene, const Instant& now);
std::optional<Eigen::Vector2d> TurnByMoments(const Scene& scene, const Instant& now);
/// Returns the moments at the second station as the force on the tip makes them (Nm).
std::optional<Eigen::Vector2d> MomentByLoad(const Scene& scene, const Instant& now);
/// Returns how far the tip lies beside the straight shaft (m): as seen, and as the load makes it.
std::optional<Eigen::Vector3d> DeflectionSeen(const Scene& scene, const Instant& now);
std::optional<Eigen::Vector3d> DeflectionByLoad(const Scene& scene, const Instant& now);

}  // namespace flextip::plausibility
