// What stands in an excerpt beside its streams: stop.csv, a row a cycle.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "stops/stop_facts.h"

namespace flextip {

/// A stop that has an excerpt.
struct KeptStop {
  std::string folder;  ///< in the recording: "stops/1_tip_disagrees"
  std::string says;    ///< words.h
  StopFacts facts;
  std::vector<std::string> warnings = {};  ///< of making the excerpt
};

struct StopsOfRun {
  std::vector<KeptStop> kept;  ///< the gravest first
  std::size_t found = 0, faults = 0;
};

/// More stops than these, the gravest, have no excerpt.
inline constexpr std::size_t kMostExcerpts = 10;

/// Returns the counts of what was found, without excerpts.
StopsOfRun StopsFound(const std::vector<StopEvent>& stops);

/// Returns the first and the last time of a stop's excerpt: ten seconds before the hold began, one
/// second after it became a fault, or began.
std::pair<TimeNs, TimeNs> SpanOf(const StopEvent& stop);

/// Returns "stops/1_tip_disagrees", below the recording.
std::string StopFolder(std::size_t number, const StopEvent& stop);

/// Writes stop.csv into the excerpt's folder. Throws WorkError.
void WriteStopTable(const std::filesystem::path& folder, const StopStory& story, TimeNs start_ns);

}  // namespace flextip
