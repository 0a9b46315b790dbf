// flextip diagnose: what the simulation gets wrong, why, and what an extended model gains.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/input/command_uses.h"
#include "apps/common/input/findings.h"
#include "apps/common/input/recording_input.h"
#include "apps/common/judgement.h"
#include "apps/common/output.h"
#include "apps/diagnose/arm.h"
#include "apps/diagnose/motion_options.h"
#include "apps/diagnose/result_files.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/judge_diagnosis.h"
#include "diagnosis/model/extended_model.h"
#include "diagnosis/planning/motion_file.h"
#include "recording/text/text.h"
#include "report/pages.h"
#include "simulation/closed_loop/gain.h"

namespace flextip {
namespace {

struct Options {
  RecordingInput input;
  std::vector<std::filesystem::path> more;  ///< further recordings, of an arm
  std::vector<std::string> without;
  MotionOptions plan;
  bool no_closed_loop = false, force = false;
};

/// Runs the controllers with and without what was found, on a plant that has it; warns of those
/// that did not come to an end.
simulation::ClosedLoopGain MeasureGain(const Recording& recording,
                                       const diagnosis::ExtendedModel& model,
                                       OutputFolder& output) {
  simulation::ClosedLoopGain gain = simulation::MeasureClosedLoopGain(recording, model);
  if (!gain.warning.empty()) output.Warn(gain.warning);
  for (const simulation::ControllerGain& run : gain.controllers) {
    if (run.ran) continue;
    output.Warn(fmt::format("closed loop: the simulated instrument lost its equilibrium under {}",
                            Name(run.kind)));
  }
  return gain;
}

void Run(const Options& options, bool quiet) {
  if (IsArmRecording(options.input.recording) || !options.more.empty()) {
    ArmRun run{{options.input.recording}, options.input.out, options.without, options.force, quiet};
    run.recordings.insert(run.recordings.end(), options.more.begin(), options.more.end());
    return DiagnoseArm(run);
  }
  const InputRead read = ReadInput(options.input, UseOfDiagnose(), quiet);
  const Recording& recording = read.recording;
  OutputFolder output(
      options.input.out, "diagnose",
      {.force = options.force, .inputs = options.input.Files(), .paths = options.input.Paths()});
  output.Warn(read.warnings);
  output.Beware(FindingsJson(read.findings));
  const diagnosis::DiagnosisResult result =
      diagnosis::Diagnose(recording, options.input.recording.string(),
                          {.without = options.without, .plan = options.plan.Limits()});
  output.Warn(result.warnings);
  const diagnosis::ExtendedModel model = diagnosis::FromResult(result);
  std::optional<simulation::ClosedLoopGain> gain;
  if (!options.no_closed_loop && diagnosis::NamesEffects(result.verdict))
    gain = MeasureGain(recording, model, output);
  WriteTextFile(output.folder() / "diagnosis.json", DiagnosisJson(result, gain ? &*gain : nullptr));
  WriteTextFile(output.folder() / "residuals.csv", ResidualsCsv(result.residuals));
  if (!result.discovered.empty())
    WriteTextFile(output.folder() / "discovered.csv", DiscoveredCsv(result.discovered));
  diagnosis::WriteModel(output.folder() / "model.yaml", model);
  if (result.plan && !result.plan->places_m.empty())
    diagnosis::WriteMotion(output.folder() / "motion.yaml", *result.plan);
  nlohmann::json summary = {
      {"verdicts", result.verdict},    {"samples", result.samples},
      {"fits", result.fits},           {"probability", result.probabilities.front().probability},
      {"converged", result.converged}, {"streams_not_used", read.NotUsed()}};
  if (result.gain.measured) summary["heldout_error_ratio"] = result.gain.heldout_error_ratio;
  if (!read.calibrations.empty()) summary["calibrations"] = CalibrationsJson(read.calibrations);
  Judgement judged = diagnosis::JudgeDiagnosis(result);
  MentionFindings(read.findings, judged);
  summary["verdict"] = JudgementJson(judged);
  output.WriteSummary(summary);
  report::WriteDiagnoseReport(output.folder());
  output.Commit();
  PrintJudgement(judged, output.paths(), quiet);
  RequireFound(judged, output.paths());
  if (quiet) return;
  if (!read.NotUsed().empty()) fmt::print("Not used: {}\n", read.NotUsed());
  fmt::print("{}\n", (options.input.out / "report.html").string());
}

}  // namespace

void AddDiagnose(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand(
      "diagnose", "What the simulation gets wrong, why, and what an extended model gains");
  auto options = std::make_shared<Options>();
  AddRecordingInput(*command, options->input);
  command->add_option("more", options->more, "Further recordings of the same arm")
      ->type_name("RECORDING");
  command
      ->add_option("--without", options->without,
                   "Effects to leave out of the catalogue (once for each)")
      ->type_name("EFFECT");
  command->add_flag("--no-closed-loop", options->no_closed_loop,
                    "Do not run the controllers with and without the model on a simulated plant "
                    "that has what was found");
  AddMotionOptions(*command, options->plan);
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Example:\n  flextip diagnose recording -o diagnosis\n"
      "  flextip diagnose recording --plan-motion --plan-speed 0.05 -o diagnosis\n");
  OnRun(*command, context, [options, &context] { Run(*options, context.quiet); });
}

}  // namespace flextip
