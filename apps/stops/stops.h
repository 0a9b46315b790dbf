// The stops of a run in a command's summary and on its terminal.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "stops/stop_files.h"

namespace flextip {

/// Gives each excerpt below `folder` its summary.json, with the run's `inputs`, its page, and the
/// page's picture as stop.png.
void WriteExcerptPages(const std::filesystem::path& folder, const StopsOfRun& stops,
                       const std::vector<std::filesystem::path>& inputs);

/// Adds `stops` (of each `says`, `excerpt`), `stops_found` and `faults`; nothing without a stop.
void AddStopsJson(const StopsOfRun& stops, nlohmann::ordered_json& summary);

/// Says the gravest three, and how many more there were; where their excerpts are.
void PrintStops(const StopsOfRun& stops, const std::filesystem::path& recording);

}  // namespace flextip
