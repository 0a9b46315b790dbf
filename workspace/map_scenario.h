// A map's scenario file for `flextip map` (keys in docs/usage/maps.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "workspace/motion_plan.h"
#include "workspace/tolerance.h"

namespace flextip {

/// tolerance: worst cases over bounded errors, and the errors that keep to a limit.
template <int N>
struct ToleranceTask {
  ToleranceQuestion<N> question;
  double spacing_m = 0.005;
};

/// plan: from a start to a goal, both in the first slice.
template <int N>
struct PlanTask {
  VectorN<N> start = VectorN<N>::Zero(), goal = VectorN<N>::Zero();
  PlanOptions options = {};
  FollowOptions follow = {};
};

template <int N>
struct MapScenario {
  MapSetup<N> setup;
  double spacing_m = 0.0025;
  std::vector<std::pair<std::string, Slice<N>>> slices;  ///< each with a name, at least one
  std::optional<ToleranceTask<N>> tolerance;
  std::optional<PlanTask<N>> plan;
};
using AnyMapScenario = std::variant<MapScenario<2>, MapScenario<3>>;

/// Throws InputError with file and line for keys that are missing, unknown or of the wrong kind,
/// and for values that make no sense.
AnyMapScenario ReadMapScenario(const std::filesystem::path& file);

}  // namespace flextip
