#include "apps/diagnose/arm.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "apps/common/judgement.h"
#include "apps/common/output.h"
#include "apps/diagnose/arm_files.h"
#include "apps/diagnose/result_files.h"
#include "arms/diagnose/diagnose.h"
#include "arms/diagnose/judge.h"
#include "arms/diagnose/model_file.h"
#include "arms/diagnose/predict.h"
#include "core/error.h"
#include "recording/recording_reader.h"
#include "recording/text/text.h"
#include "report/pages.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;

/// The folder's own name; of several alike, with a number.
std::vector<std::string> NamesOf(const std::vector<fs::path>& recordings) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const fs::path& path : recordings) {
    const fs::path whole = fs::absolute(path).lexically_normal();
    std::string name = (whole.has_filename() ? whole : whole.parent_path()).filename().string();
    for (int i = 2; !taken.insert(name).second; ++i)
      name = fmt::format(
          "{}_{}", (whole.has_filename() ? whole : whole.parent_path()).filename().string(), i);
    names.push_back(name);
  }
  return names;
}

std::vector<arms::ArmData> ReadArms(const ArmRun& run, OutputFolder& output) {
  const std::vector<std::string> names = NamesOf(run.recordings);
  std::vector<arms::ArmData> all;
  for (std::size_t r = 0; r < run.recordings.size(); ++r) {
    const ReadResult read = ReadRecording(run.recordings[r]);
    output.Warn(read.warnings);
    if (!read.recording.HasArm()) {
      throw InputError::At(run.recordings[r].string(), 0,
                           "no joints of an arm, expected joints0, or joints_command0 with "
                           "joints_seen0, in every recording");
    }
    all.emplace_back(read.recording, names[r]);
  }
  return all;
}

OutputOptions OptionsOf(const ArmRun& run, const fs::path& model = {}) {
  OutputOptions options{.force = run.force, .inputs = run.recordings, .paths = {}};
  if (!model.empty()) options.inputs.push_back(model);
  options.paths.recording = run.recordings.front();
  return options;
}

void Say(const Judgement& judged, const OutputFolder& output, const ArmRun& run) {
  PrintJudgement(judged, output.paths(), run.quiet);
  RequireFound(judged, output.paths());
  if (!run.quiet) fmt::print("{}\n", (run.out / "report.html").string());
}

}  // namespace

bool IsArmRecording(const fs::path& recording) {
  const auto has = [&](const char* sensor) { return fs::is_directory(recording / sensor); };
  const bool has_shaft = has("em0") || has("vision0") || has("strain0");
  if (has("joints0") && has_shaft) return false;  // of a shaft that an arm holds
  return has("joints0") || (has("joints_command0") && has("joints_seen0"));
}

void DiagnoseArm(const ArmRun& run) {
  OutputFolder output(run.out, "diagnose", OptionsOf(run));
  const std::vector<arms::ArmData> recordings = ReadArms(run, output);
  const arms::ArmResult result = arms::Diagnose(recordings, {.without = run.without});
  output.Warn(result.answer.warnings);
  std::optional<simulation::JointGain> gain;
  if (run.closed_loop && diagnosis::NamesEffects(result.answer.verdict))
    gain = simulation::MeasureJointGain(recordings.front(), result.model);
  WriteTextFile(output.folder() / "diagnosis.json",
                ArmDiagnosisJson(result, gain ? &*gain : nullptr));
  WriteTextFile(output.folder() / "model.yaml", arms::ArmModelYaml(result.model));
  report::WriteFigures(output.folder() / "figures.json", ArmFigures(result));
  WriteTextFile(output.folder() / "residuals.csv", ResidualsCsv(result.answer.residuals));
  for (const arms::RecordingAnswer& own : result.each)
    WriteTextFile(output.folder() / "recordings" / own.name / "diagnosis.json",
                  ArmRecordingJson(own));
  nlohmann::json summary = {{"verdicts", result.answer.verdict},
                            {"samples", result.answer.samples},
                            {"fits", result.answer.fits},
                            {"probability", result.answer.probabilities.front().probability},
                            {"converged", result.answer.converged}};
  if (result.answer.gain.measured)
    summary["heldout_error_ratio"] = result.answer.gain.heldout_error_ratio;
  const Judgement judged = arms::JudgeArm(result);
  summary["verdict"] = JudgementJson(judged);
  output.WriteSummary(summary);
  report::WriteDiagnoseReport(output.folder());
  output.Commit();
  Say(judged, output, run);
}

void PredictArm(const ArmRun& run, const fs::path& model) {
  OutputFolder output(run.out, "predict", OptionsOf(run, model));
  const std::vector<arms::ArmData> recordings = ReadArms(run, output);
  const arms::ArmPrediction found = arms::Predict(recordings.front(), arms::ReadArmModel(model));
  report::WriteFigures(output.folder() / "figures.json", CurveFigures(found.curves));
  WriteTextFile(output.folder() / "residuals.csv", ResidualsCsv(found.residuals));
  nlohmann::json summary = ArmPredictionSummary(found);
  const Judgement judged = arms::JudgeArmPrediction(found);
  summary["verdict"] = JudgementJson(judged);
  output.WriteSummary(summary);
  report::WritePredictReport(output.folder());
  output.Commit();
  Say(judged, output, run);
}

}  // namespace flextip
