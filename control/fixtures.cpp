#include "control/fixtures.h"

#include <algorithm>

namespace flextip {
namespace {

constexpr int kRounds = 30;
constexpr double kLeft_m = 1e-7;  // a region that moves the tip by less leaves it alone

/// Where one region puts `p`; a guiding path leaves it alone.
FixtureOutput OutOf(const Fixture& fixture, const Eigen::Vector3d& p, double margin_m) noexcept {
  if (const auto* half_space = std::get_if<ForbiddenHalfSpace>(&fixture)) {
    return Constrain(*half_space, p, margin_m);
  }
  if (const auto* sphere = std::get_if<ForbiddenSphere>(&fixture)) {
    return Constrain(*sphere, p, margin_m);
  }
  if (const auto* mesh = std::get_if<ForbiddenMesh>(&fixture)) return mesh->Constrain(p, margin_m);
  return {FixtureStatus::kFree, p, 0.0, Eigen::Vector3d::Zero()};
}

/// Goes once through the regions. Returns whether all of them left the tip of `output` alone.
bool AllLeave(const Fixtures& fixtures, double margin_m, FixturesOutput& output) noexcept {
  bool left = true;
  for (const Fixture& fixture : fixtures.list) {
    const FixtureOutput moved = OutOf(fixture, output.p_RE_desired, margin_m);
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
