// flextip calibrate em: where the EM system stands, where its sensor sits, how its field is bent.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/calibrate/calibrate.h"
#include "apps/calibrate/em/output.h"
#include "apps/calibrate/verdict_json.h"
#include "apps/common/input/command_uses.h"
#include "apps/common/input/findings.h"
#include "apps/common/input/recording_input.h"
#include "apps/common/output.h"
#include "calibration/em/em_calibration.h"
#include "calibration/em/pairs.h"
#include "calibration/entries.h"
#include "calibration/verdict/em.h"
#include "core/error.h"
#include "recording/text/text.h"
#include "report/pages.h"

namespace flextip {
namespace {

struct CalibrateEmOptions {
  RecordingInput input;
  std::string reference = "wrist";
  bool force = false;
};

EmPairs PairsOf(const CalibrateEmOptions& options, const Recording& recording) {
  const auto missing = [&](const std::string& what) {
    return InputError::At(options.input.recording.string(), 0, what);
  };
  if (!recording.em0) throw missing("found no em0/, expected the sensor's positions");
  if (options.reference == "vision") {
    if (!recording.vision0) throw missing("found no vision0/, --reference vision needs it");
    return PairByVision(recording);
  }
  if (!recording.wrist0) throw missing("found no wrist0/, --reference wrist needs it");
  return PairByWrist(recording);
}

void PrintResult(const CalibrateEmOptions& options, const EmResult& result) {
  for (const auto& [parameter, reason] : result.unobservable) {
    fmt::print("{} cannot be named: {}\n", parameter, reason);
  }
  if (result.IsUsable()) {
    fmt::print("residual {:.3f} mm RMS per component by the registration alone",
               1e3 * result.rms_before_m);
    for (const EmCandidate& c : result.candidates) {
      if (c.chosen) fmt::print(", {:.3f} mm with {}", 1e3 * result.rms_after_m, c.name);
    }
    fmt::print("; {} of {} samples used\n", result.used, result.residuals.size());
  }
  fmt::print("{}\n", (options.input.out / "calibration.yaml").string());
}

void RunCalibrateEm(const CalibrateEmOptions& options, bool quiet) {
  OutputFolder output(options.input.out, "calibrate em",
                      {.force = options.force,
                       .inputs = {options.input.recording},
                       .paths = options.input.Paths()});
  const auto read = ReadInput(options.input, UseOfEm(options.reference), quiet);
  output.Warn(read.warnings);
  output.Beware(FindingsJson(read.findings));
  const EmPairs found = PairsOf(options, read.recording);
  output.Warn(found.warnings);
  const EmResult result =
      CalibrateEm(found.pairs, {.distance_from_tip_m = read.recording.em0->distance_from_tip_m});
  for (const auto& [parameter, reason] : result.unobservable) {
    output.Warn(fmt::format("{} cannot be named: {}", parameter, reason));
  }
  if (const std::string lag = LagText(result); !lag.empty()) output.Warn(lag);
  WriteCalibration(output.folder() / "calibration.yaml", EmEntries(result));
  if (!result.residuals.empty()) {
    WriteTextFile(output.folder() / "residuals.csv", EmResidualTable(found.pairs, result));
    report::WriteFigures(output.folder() / "figures.json", EmFigures(found.pairs, result));
  }
  auto summary = EmSummary(found.pairs, result);
  summary["verdict"] = VerdictJson(JudgeEm(result));
  summary["reference"] = options.reference;
  summary["samples_without_reference"] = found.left_out;
  output.WriteSummary(summary);
  report::WriteCalibrateReport(output.folder());
  output.Commit();
  if (!quiet) PrintResult(options, result);
}

}  // namespace

void AddCalibrateEm(CLI::App& calibrate, AppContext& context) {
  auto* command = calibrate.add_subcommand(
      "em", "Where the EM system stands in R, where its sensor sits, how metal bends its field");
  auto options = std::make_shared<CalibrateEmOptions>();
  AddRecordingInput(*command, options->input);
  command
      ->add_option("--reference", options->reference,
                   "What says where the sensor must be: wrist (the straight shaft through the "
                   "port) or vision (the tip as seen)")
      ->check(CLI::IsMember({"wrist", "vision"}))
      ->capture_default_str();
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Move the unloaded instrument through the whole space it will work in.\n"
      "Example:\n"
      "  flextip calibrate em RECORDING -o em\n");
  OnRun(*command, context, [options, &context] { RunCalibrateEm(*options, context.quiet); });
}

}  // namespace flextip
