// The run that calibrate stiffness and calibrate strain share: known loads in, one folder out.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/input/recording_input.h"
#include "apps/common/output.h"
#include "calibration/shaft/known_loads.h"
#include "calibration/verdict/verdict.h"
#include "report/figure.h"

namespace flextip {

/// What a result folder is made of.
struct ShaftFindings {
  const Calibration& found;
  std::string residuals;                ///< residuals.csv
  std::vector<report::Figure> figures;  ///< none: no figures.json
  nlohmann::json summary;
  CalibrationVerdict verdict;
};

/// Reads the recording and begins the folder; its warnings begin with the reading's.
struct ShaftRun {
  ShaftRun(const RecordingInput& from, const plausibility::CommandUse& use, bool force, bool quiet);

  /// Writes all files, the page too, and puts the folder in its place.
  void Write(const ShaftFindings& findings);
  /// Prints the load that would help most, where there is one, and the file to use.
  void PrintNext(const std::string& advice) const;

  const RecordingInput& input;
  InputRead read;
  OutputFolder output;
};

double SecondsAfter(TimeNs start_ns, const LoadHold& hold);

/// `holds_used` and `holds_rejected` of the summary.
template <class Holds>
nlohmann::json HoldsJson(const Holds& holds) {
  int used = 0;
  nlohmann::json rejected = nlohmann::json::array();
  for (const auto& h : holds) {
    used += h.used;
    if (h.used) continue;
    rejected.push_back(
        {{"hold", SpanOf(h.hold, holds.front().hold.first_ns)}, {"reason", h.reason}});
  }
  return {{"holds_used", used}, {"holds_rejected", rejected}};
}

/// Warns of each hold that is not used, with the reason.
template <class Holds>
void WarnOfHolds(const Holds& holds, OutputFolder& output) {
  for (const auto& h : holds) {
    if (!h.used) output.Warn(SpanOf(h.hold, holds.front().hold.first_ns) + ": " + h.reason);
  }
}

}  // namespace flextip
