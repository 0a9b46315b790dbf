// A scenario file for `flextip simulate` (keys in docs/scenarios.md).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "simulation/closed_loop/closed_loop.h"
#include "simulation/render/laparoscope.h"

namespace flextip::simulation {

struct Scenario {
  LoopSetup loop;  ///< of any controller: `loop.controller.kind` is set for each run
  std::vector<ControllerKind> controllers;
  bool has_camera = false;  ///< camera, collar and the options below are there
  LaparoscopeOptions laparoscope;
  TrackerOptions tracker;
  std::vector<std::string> warnings;
};

/// Returns the longest time (s) that the loop's path takes.
double PathSeconds(const LoopSetup& loop);

/// Throws InputError with file and line for keys that are missing, unknown or of the wrong kind,
/// values out of range, and a port that the shaft cannot reach.
Scenario ReadScenario(const std::filesystem::path& file);

}  // namespace flextip::simulation
