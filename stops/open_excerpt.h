// An excerpt around a stop while the run's cycles go by once more.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "stops/moment.h"
#include "stops/stop_facts.h"
#include "stops/stop_files.h"
#include "stops/stop_finder.h"

namespace flextip {

struct OpenExcerpt {
  StopEvent stop;
  std::size_t number = 0;  ///< among the kept stops
  TimeNs from_ns = 0, to_ns = 0;
  std::string state;  ///< of the controller before its first cycle; empty: it has not begun
  std::vector<Moment> moments;
  long differ = 0;  ///< cycles that came out otherwise than they were recorded
};

/// Returns an excerpt for each of the gravest stops, and enters these in `stops`.
std::vector<OpenExcerpt> OpenExcerpts(const std::vector<StopEvent>& found, StopsOfRun& stops);

/// Tells what happened: a sentence in `stops`, and `stop.csv` in the excerpt's `folder`. `detail`
/// as in StopFacts. `why`: what it means where cycles came out otherwise.
void CloseExcerpt(const OpenExcerpt& open, const StoppedRun& run,
                  const std::filesystem::path& folder, const std::string& detail,
                  const std::string& why, StopsOfRun& stops);

}  // namespace flextip
