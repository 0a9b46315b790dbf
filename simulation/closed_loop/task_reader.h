// What a scenario asks of the tip: its sections path, fixtures, controllers and control. Private to
// closed_loop.
#pragma once

#include <filesystem>
#include <vector>

#include "recording/text/yaml_map.h"
#include "simulation/closed_loop/scenario.h"

namespace flextip::simulation {

/// Reads a direction and makes it a unit vector. Throws InputError for a zero vector.
Eigen::Vector3d ReadUnit(const YamlMap& map, const std::string& key);

/// Reads the sections into `scenario` and adds them to `sections`, for the check of unknown keys.
/// Files are named relative to `folder`. Throws InputError with file and line.
void ReadTask(const YamlMap& top, const std::filesystem::path& folder, Scenario& scenario,
              std::vector<YamlMap>& sections);

}  // namespace flextip::simulation
