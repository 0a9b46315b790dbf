// flextip align: the clocks of a recording's streams, from the motion that the streams share.
#include <fmt/format.h>

#include <memory>

#include "apps/align/output.h"
#include "apps/calibrate/verdict_json.h"
#include "apps/common/commands.h"
#include "apps/common/input/recording_input.h"
#include "apps/common/output.h"
#include "calibration/clock/motion.h"
#include "calibration/verdict/clock.h"
#include "core/error.h"
#include "report/pages.h"

namespace flextip {
namespace {

struct AlignOptions {
  RecordingInput input;
  ClockOptions clocks;
  bool force = false;
};

void Print(const CalibrationVerdict& verdict, const std::filesystem::path& folder) {
  fmt::print("{}\n", verdict.says);
  for (const auto& reason : verdict.reasons) fmt::print("- {}\n", reason);
  for (const auto& one : verdict.not_found) fmt::print("not found: {}\n", one.reason);
  fmt::print("{}\n", (folder / "report.html").string());
}

void CheckReference(const std::string& reference, const Recording& recording) {
  if (reference.empty()) return;
  const Motions motions = MotionsOf(recording);
  if (motions.Find(reference) == nullptr) {
    throw InputError(fmt::format("--reference {}: expected one of {}", reference, motions.Names()));
  }
}

void RunAlign(const AlignOptions& options, bool quiet) {
  InputRead read = ReadInput(options.input);
  const Recording& recording = read.recording;
  CheckReference(options.clocks.reference, recording);
  const ClockResult result = AlignClocks(recording, options.clocks);
  const CalibrationVerdict verdict = JudgeClocks(result);
  OutputFolder output(
      options.input.out, "align",
      {.force = options.force, .inputs = options.input.Files(), .paths = options.input.Paths()});
  output.Warn(read.warnings);
  const std::string camera = recording.vision0 ? recording.vision0->camera : "cam0";
  WriteCalibration(output.folder() / "calibration.yaml", ClockEntries(result, camera));
  report::WriteFigures(output.folder() / "figures.json", ClockFigures(recording, result));
  nlohmann::json summary = ClockSummary(result);
  summary["verdict"] = VerdictJson(verdict);
  summary["calibrations"] = CalibrationsJson(read.calibrations);
  output.WriteSummary(summary);
  report::WriteReport(output.folder());
  output.Commit();
  if (!quiet) Print(verdict, output.name());
  if (verdict.grade == Grade::kNotFound) throw WorkError(verdict.says);
}

}  // namespace

void AddAlign(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand(
      "align", "Offset and rate between the streams' clocks, from the motion they share");
  auto options = std::make_shared<AlignOptions>();
  AddRecordingInput(*command, options->input);
  command->add_option("--reference", options->clocks.reference,
                      "Stream whose clock holds; without it wrist0, or the first that moves");
  command->add_option("--most", options->clocks.most_offset_s, "Largest offset to look for, s")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 3600.0));
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Needs half a minute in which the instrument moves, fast and not always the same.\n"
      "Example:\n"
      "  flextip align RECORDING -o clocks\n"
      "  flextip estimate RECORDING --calibration clocks/calibration.yaml -o estimated\n");
  OnRun(*command, context, [options, &context] { RunAlign(*options, context.quiet); });
}

}  // namespace flextip
