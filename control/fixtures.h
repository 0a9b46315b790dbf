// The virtual fixtures of a run together: they change a desired tip before the controller gets it.
#pragma once

#include <Eigen/Dense>
#include <variant>
#include <vector>

#include "control/virtual_fixture.h"
#include "control/virtual_fixture_mesh.h"

namespace flextip {

using Fixture = std::variant<PathGuidance, ForbiddenHalfSpace, ForbiddenSphere, ForbiddenMesh>;

struct Fixtures {
  std::vector<Fixture> list;
  double margin_m = 0.0;   ///< kept from every forbidden region
  double margin_sd = 0.0;  ///< and so many standard deviations of the tip
};

struct FixturesOutput {
  FixtureStatus status = FixtureStatus::kFree;
  Eigen::Vector3d p_RE_desired = Eigen::Vector3d::Zero();
};

/// Returns the desired tip `p` (m, in R) drawn to the guiding paths and then moved out of the
/// forbidden regions, in turn until none moves it or thirty rounds are over (kNotClear).
/// `tip_sd_m`: how well the tip is known. Bounded, without allocation, never throws.
FixturesOutput Constrain(const Fixtures& fixtures, const Eigen::Vector3d& p,
                         double tip_sd_m) noexcept;

}  // namespace flextip
