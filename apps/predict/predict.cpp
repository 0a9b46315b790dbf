// flextip predict: how well base and extended model predict a recording that was not fitted.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/input/command_uses.h"
#include "apps/common/input/findings.h"
#include "apps/common/input/recording_input.h"
#include "apps/common/judgement.h"
#include "apps/common/output.h"
#include "apps/diagnose/arm.h"
#include "apps/diagnose/held.h"
#include "apps/diagnose/result_files.h"
#include "diagnosis/model/extended_model.h"
#include "diagnosis/prediction/predict.h"
#include "recording/text/text.h"
#include "report/pages.h"

namespace flextip {
namespace {

struct Options {
  RecordingInput input;
  std::filesystem::path model;
  bool force = false;
};

nlohmann::json Summary(const diagnosis::Prediction& found, const diagnosis::ExtendedModel& model) {
  nlohmann::json effects = nlohmann::json::array();
  for (const diagnosis::EffectFit& fit : model.effects) effects.push_back(fit.effect);
  nlohmann::json summary = {{"effects", effects},
                            {"samples", found.samples},
                            {"judged_samples", found.judged},
                            {"base_rms", found.base.heldout_rms},
                            {"extended_rms", found.extended.heldout_rms},
                            {"base_tip_rms_m", found.base.tip_prediction_rms_m},
                            {"extended_tip_rms_m", found.extended.tip_prediction_rms_m},
                            {"base_tip_mean_m", found.base_tip_mean_m},
                            {"extended_tip_mean_m", found.extended_tip_mean_m},
                            {"base_weighted_rms", found.base.weighted_rms},
                            {"extended_weighted_rms", found.extended.weighted_rms},
                            {"base_chi2_per_dof", found.base.chi2_per_dof},
                            {"extended_chi2_per_dof", found.extended.chi2_per_dof},
                            {"not_shown", found.not_shown}};
  if (!found.gain.measured) return summary;
  summary["ratio"] = found.gain.heldout_error_ratio;
  summary["ratio_interval"] = {found.gain.heldout_error_ratio_low,
                               found.gain.heldout_error_ratio_high};
  summary["tip_ratio"] = found.gain.tip_error_ratio;
  return summary;
}

void Run(const Options& options, bool quiet) {
  if (IsArmRecording(options.input.recording)) {
    return PredictArm({{options.input.recording}, options.input.out, {}, options.force, quiet},
                      options.model);
  }
  const ShaftInput input = ReadShaft(options.input, UseOfPredict(), quiet);
  const InputRead& read = input.read;
  const diagnosis::ExtendedModel model = diagnosis::ReadModel(options.model, input.JointEffects());
  std::vector<std::filesystem::path> inputs = options.input.Files();
  inputs.push_back(options.model);
  CommandPaths paths = options.input.Paths();
  paths.model = options.model;
  OutputFolder output(options.input.out, "predict",
                      {.force = options.force, .inputs = inputs, .paths = paths});
  output.Warn(read.warnings);
  output.Beware(FindingsJson(read.findings));
  const diagnosis::Prediction found = diagnosis::Predict(
      read.recording, options.input.recording.string(), model, input.JointEffects());
  output.Warn(found.warnings);
  WriteTextFile(output.folder() / "residuals.csv", ResidualsCsv(found.residuals));
  nlohmann::json summary = Summary(found, model);
  summary["streams_not_used"] = read.NotUsed();
  if (!read.calibrations.empty()) summary["calibrations"] = CalibrationsJson(read.calibrations);
  Judgement judged = diagnosis::JudgePrediction(found);
  MentionFindings(read.findings, judged);
  summary["verdict"] = JudgementJson(judged);
  output.WriteSummary(summary);
  report::WritePredictReport(output.folder());
  output.Commit();
  PrintJudgement(judged, output.paths(), quiet);
  RequireFound(judged, output.paths());
  if (!quiet) fmt::print("{}\n", (options.input.out / "report.html").string());
}

}  // namespace

void AddPredict(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand(
      "predict", "How well base and extended model predict a recording that was not fitted");
  auto options = std::make_shared<Options>();
  AddRecordingInput(*command, options->input);
  command->add_option("--model", options->model, "The extended model, from flextip diagnose")
      ->required()
      ->type_name("MODEL.yaml");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Example:\n  flextip predict recording --model diagnosis/model.yaml -o prediction\n");
  OnRun(*command, context, [options, &context] { Run(*options, context.quiet); });
}

}  // namespace flextip
