#include "apps/calibrate/shaft/run.h"

#include <fmt/format.h>

#include "apps/calibrate/verdict_json.h"
#include "apps/common/input/findings.h"
#include "recording/text/text.h"
#include "report/pages.h"

namespace flextip {

ShaftRun::ShaftRun(const RecordingInput& from, const plausibility::CommandUse& use, bool force,
                   bool quiet)
    : input(from),
      read(ReadInput(from, use, quiet)),
      output(from.out, use.command,
             {.force = force, .inputs = from.Files(), .paths = from.Paths()}) {
  output.Warn(read.warnings);
  output.Beware(FindingsJson(read.findings));
}

void ShaftRun::Write(const ShaftFindings& findings) {
  const auto& folder = output.folder();
  WriteCalibration(folder / "calibration.yaml", findings.found);
  WriteTextFile(folder / "residuals.csv", findings.residuals);
  if (!findings.figures.empty()) report::WriteFigures(folder / "figures.json", findings.figures);
  nlohmann::json summary = findings.summary;
  summary["unobservable"] = UnobservableJson(findings.found.unobservable);
  summary["verdict"] = VerdictJson(findings.verdict);
  if (!read.calibrations.empty()) summary["calibrations"] = CalibrationsJson(read.calibrations);
  output.WriteSummary(summary);
  report::WriteCalibrateReport(folder);
  output.Commit();
}

void ShaftRun::PrintNext(const std::string& advice) const {
  if (!advice.empty()) fmt::print("next, this would help most: {}\n", advice);
  fmt::print("{}\n", (input.out / "calibration.yaml").string());
}

double SecondsAfter(TimeNs start_ns, const LoadHold& hold) {
  return 1e-9 * static_cast<double>(hold.first_ns - start_ns);
}

}  // namespace flextip
