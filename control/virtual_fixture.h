// Virtual fixtures: they keep a desired tip position out of a forbidden region, or draw it to a
// path, before the controller gets it (thesis 5.2.6; Abbott and Okamura 2003, Marayong 2003).
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

namespace flextip {

enum class FixtureStatus : std::uint8_t {
  kFree,      ///< left as it was
  kMoved,     ///< projected out of the region, or drawn to the path
  kNotClear,  ///< moved, but the margin could not be kept: the space left is narrower than it
  kBadInput,  ///< the position is not finite or absurdly far, the margin negative, or the region
              ///< has no meaning (normal not unit, radius negative): `p_RE_desired` is the input
};
const char* Name(FixtureStatus status);

/// Everything in R.
struct FixtureOutput {
  FixtureStatus status = FixtureStatus::kBadInput;
  Eigen::Vector3d p_RE_desired = Eigen::Vector3d::Zero();  ///< for the controller
  double depth_m = 0.0;  ///< of the input in the region; negative: its distance from it
  Eigen::Vector3d normal =
      Eigen::Vector3d::Zero();  ///< unit, out of the region, at the nearest place
};

/// Forbidden: everything behind the plane. `normal` (unit) points out of it.
struct ForbiddenHalfSpace {
  Eigen::Vector3d p_plane = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
};

/// Forbidden: the inside of a sphere, or all but its inside.
struct ForbiddenSphere {
  Eigen::Vector3d p_centre = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
  bool forbidden_outside = false;
};

/// Returns the desired position as near to `p` as the region permits: outside, and `margin_m` (0 or
/// more) away. Bounded, without allocation, never throws.
FixtureOutput Constrain(const ForbiddenHalfSpace& region, const Eigen::Vector3d& p,
                        double margin_m = 0.0) noexcept;
/// Returns the same for a sphere. In its centre, where every direction is as near, `p` leaves along
/// z.
FixtureOutput Constrain(const ForbiddenSphere& region, const Eigen::Vector3d& p,
                        double margin_m = 0.0) noexcept;

struct GuidanceOutput {
  FixtureStatus status = FixtureStatus::kBadInput;
  Eigen::Vector3d p_RE_desired = Eigen::Vector3d::Zero();
  Eigen::Vector3d p_path = Eigen::Vector3d::Zero();    ///< nearest place on the path
  Eigen::Vector3d tangent = Eigen::Vector3d::UnitX();  ///< of the path there, unit
  double s_m = 0.0;                                    ///< along the path, from its beginning
  double distance_m = 0.0;                             ///< of the input from the path
};

/// A polyline along which motion is free, while across it only a part of a deviation is let
/// through.
class PathGuidance {
 public:
  /// Takes two or more finite `points` (m, in R), no two following ones the same. `compliance`: the
  /// part of a deviation that is let through, 0 (on the path) to 1 (no guidance). Within
  /// `free_radius_m` of the path nothing is changed. Throws InputError where a value is not so.
  PathGuidance(std::vector<Eigen::Vector3d> points, double compliance = 0.0,
               double free_radius_m = 0.0);

  /// Looks at every segment; without allocation, never throws.
  GuidanceOutput Guide(const Eigen::Vector3d& p) const noexcept;

  double Length() const { return s_m_.back(); }

 private:
  std::vector<Eigen::Vector3d> points_;
  std::vector<double> s_m_;  // of the points
  double compliance_, free_radius_m_;
};

}  // namespace flextip
