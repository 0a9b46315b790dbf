// Sections of a scenario file that have a file of their own. Private to closed_loop.
#pragma once

#include <filesystem>
#include <vector>

#include "recording/text/yaml_map.h"
#include "simulation/closed_loop/scenario.h"
#include "simulation/sensors/sensors.h"

namespace flextip::simulation {

/// Returns the vector at `key`, or `fallback` where the map has none.
inline Eigen::Vector3d VectorOr(const YamlMap& map, const std::string& key,
                                const Eigen::Vector3d& fallback) {
  return map.Has(key) ? map.Vector3(key) : fallback;
}

/// Reads the section `sensors` of a shaft of `length_m`. The sections in it are added to
/// `sections`, to find the keys that nobody asked for. Throws InputError with file and line.
SensorSetup ReadScenarioSensors(const YamlMap& map, double length_m,
                                std::vector<YamlMap>& sections);

/// Reads the section `camera` into `scenario`, which has its sensors: camera and collar are files
/// in a recording's own format, named relative to `folder`. Sections and errors as above.
void ReadScenarioCamera(const YamlMap& map, const std::filesystem::path& folder,
                        std::vector<YamlMap>& sections, Scenario& scenario);

}  // namespace flextip::simulation
