#include "control/fixtures.h"

#include <algorithm>

namespace flextip {
namespace {

constexpr int kRounds = 30;
constexpr double kLeft_m = 1e-7;  // a region that moves the tip by less leaves it alone

/// Where one region puts `p`; a guiding path is none.
struct OutOf {
  const Eigen::Vector3d& p;
  double margin_m;

  FixtureOutput operator()(const PathGuidance&) const noexcept {
    return {FixtureStatus::kFree, p, 0.0, Eigen::Vector3d::Zero()};
  }
  FixtureOutput operator()(const ForbiddenHalfSpace& region) const noexcept {
    return Constrain(region, p, margin_m);
  }
  FixtureOutput operator()(const ForbiddenSphere& region) const noexcept {
    return Constrain(region, p, margin_m);
  }
  FixtureOutput operator()(const ForbiddenMesh& region) const noexcept {
    return region.Constrain(p, margin_m);
  }
};

/// Goes once through the regions. Returns whether all of them left the tip of `output` alone.
bool AllLeave(const Fixtures& fixtures, double margin_m, FixturesOutput& output) noexcept {
  bool left = true;
  for (const Fixture& fixture : fixtures.list) {
    const FixtureOutput moved = std::visit(OutOf{output.p_RE_desired, margin_m}, fixture);
    if (moved.status == FixtureStatus::kFree) continue;
    left &= (moved.p_RE_desired - output.p_RE_desired).norm() < kLeft_m;
    output.p_RE_desired = moved.p_RE_desired;
    output.status = std::max(output.status, moved.status);
  }
  return left;
}

}  // namespace

FixturesOutput Constrain(const Fixtures& fixtures, const Eigen::Vector3d& p,
                         double tip_sd_m) noexcept {
  FixturesOutput output{FixtureStatus::kFree, p};
  if (fixtures.list.empty()) return output;
  for (const Fixture& fixture : fixtures.list) {
    const auto* path = std::get_if<PathGuidance>(&fixture);
    if (path == nullptr) continue;
    const GuidanceOutput guided = path->Guide(output.p_RE_desired);
    output.p_RE_desired = guided.p_RE_desired;
    output.status = std::max(output.status, guided.status);
  }
  const double margin_m = fixtures.margin_m + fixtures.margin_sd * tip_sd_m;
  for (int round = 0; round < kRounds; ++round) {
    if (AllLeave(fixtures, margin_m, output) || output.status == FixtureStatus::kBadInput)
      return output;
  }
  output.status = FixtureStatus::kNotClear;
  return output;
}

}  // namespace flextip
