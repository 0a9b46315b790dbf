// The stops of a recorded session as recordings of their own.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "live/session/session.h"
#include "recording/read_log.h"
#include "stops/stop_files.h"
#include "stops/stop_finder.h"

namespace flextip::live {

/// Returns the stops of a recorded session, by its cycles.csv. None in recordings of before the
/// table had the supervisor's findings. Throws InputError with file and line.
std::vector<StopEvent> FindStops(const std::filesystem::path& recording, ReadLog& log);

/// Writes an excerpt for each of the gravest stops into `to`/stops: a recording from ten seconds
/// before the hold until a second after it became a fault, or after it began. Runs the session
/// again, so that each has the cycle's state at its begin: `replay` gives its commands bit for bit.
/// Throws InputError and WorkError.
StopsOfRun WriteExcerpts(const std::filesystem::path& recording, const std::filesystem::path& to);

}  // namespace flextip::live
