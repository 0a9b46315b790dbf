// The stops of a recorded simulation as recordings of their own.
#pragma once

#include <filesystem>
#include <vector>

#include "simulation/closed_loop/replay.h"
#include "simulation/closed_loop/scenario.h"
#include "stops/stop_files.h"
#include "stops/stop_finder.h"

namespace flextip::simulation {

/// Returns whether the recording has every cycle's inputs: that of a supervised run has.
bool HasLoop(const std::filesystem::path& recording);

/// Steps the controller `kind` of `scenario` through the recorded inputs; an excerpt from the state
/// that the run had at its begin. Throws InputError with file and line.
std::vector<ReplayedCommand> ReplayLoop(const Scenario& scenario, ControllerKind kind,
                                        const std::filesystem::path& recording);

/// Returns the stops of a recording that has its cycles. Throws InputError with file and line.
std::vector<StopEvent> FindStops(const std::filesystem::path& recording);

/// Writes an excerpt for each of the gravest stops into `to`/stops, as live/recorder/excerpt.h does
/// for sessions. Throws InputError and WorkError.
StopsOfRun WriteExcerpts(const Scenario& scenario, ControllerKind kind,
                         const std::filesystem::path& recording, const std::filesystem::path& to);

}  // namespace flextip::simulation
