// flextip estimate: the instrument's load, port and shape at every sample of a recording.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/commands.h"
#include "apps/common/input/command_uses.h"
#include "apps/common/input/findings.h"
#include "apps/common/input/recording_input.h"
#include "apps/common/judgement.h"
#include "apps/common/length_option.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "apps/diagnose/held.h"
#include "apps/estimate/figures.h"
#include "core/error.h"
#include "diagnosis/model/extended_instrument.h"
#include "diagnosis/model/latency.h"
#include "pipeline/estimate_recording.h"
#include "pipeline/judge_estimates.h"
#include "pipeline/sensor_readings.h"
#include "recording/text/csv.h"
#include "recording/text/text.h"
#include "recording/tip_score.h"
#include "report/pages.h"

namespace flextip {
namespace {

struct EstimateOptions {
  RecordingInput input;
  std::filesystem::path model;
  double port_prior_m = kPortRegistration_m;
  int window_samples = 0;
  bool without_positions = false, force = false;
};

using Estimates = Series<ShaftEstimate>;

const std::vector<std::string> kColumns = {
    "timestamp [ns]",     "p_RE_x [m]",  "p_RE_y [m]",  "p_RE_z [m]",      "sd_RE_x [m]",
    "sd_RE_y [m]",        "sd_RE_z [m]", "d_RE_x []",   "d_RE_y []",       "d_RE_z []",
    "f_tip_x [N]",        "f_tip_y [N]", "f_tip_z [N]", "sd_f_tip_x [N]",  "sd_f_tip_y [N]",
    "sd_f_tip_z [N]",     "p_RP_x [m]",  "p_RP_y [m]",  "p_RP_z [m]",      "s_port [m]",
    "F_p_over_EI [1/m2]", "a [m]",       "chi2 []",     "measurements []", "status []"};

void AddVector(CsvWriter& csv, const Eigen::Vector3d& v) {
  for (int i = 0; i < 3; ++i) csv.Add(v[i]);
}

/// Numbers only where there is an estimate; the status always.
void AddRow(CsvWriter& csv, TimeNs t_ns, const ShaftEstimate& e) {
  csv.Add(t_ns);
  if (e.status == EstimateStatus::kOk || e.status == EstimateStatus::kUnobservable) {
    AddVector(csv, e.p_RE);
    AddVector(csv, e.p_RE_covariance_m2.diagonal().cwiseMax(0.0).cwiseSqrt());
    AddVector(csv, e.d_RE);
    AddVector(csv, e.model.f_tip_N);
    AddVector(csv, e.covariance.diagonal().tail<3>().cwiseMax(0.0).cwiseSqrt());
    AddVector(csv, e.model.p_RP);
    csv.Add(e.s_port_m);
    if (e.model.beam.IsUsable()) {
      csv.Add(e.model.beam.F_p_over_EI).Add(e.model.beam.a);
    } else {
      csv.AddEmpty(2);
    }
    csv.Add(e.chi2);
  } else {
    csv.AddEmpty(22);
  }
  csv.Add(static_cast<double>(e.measurements)).Add(std::string(Name(e.status)));
  csv.EndRow();
}

EstimatorOptions MakeOptions(const Recording& recording, const EstimateOptions& options) {
  EstimatorOptions estimator = EstimatorOptionsFor(recording.instrument, recording.p_RP,
                                                   recording.gravity_m_s2, options.port_prior_m);
  estimator.use_positions = !options.without_positions;
  estimator.estimate_tissue = false;  // for the controllers only
  return estimator;
}

Estimates EstimateAll(const ShaftInput& input, const EstimateOptions& options,
                      InstrumentEstimator& estimator, bool quiet) {
  const Recording& recording = input.read.recording;
  Progress progress("estimate", EstimationTimes(recording).size(), quiet);
  const auto update = [&](std::size_t done, std::size_t) { progress.Update(done); };
  if (options.model.empty()) return EstimateRecording(recording, estimator, nullptr, update);
  const diagnosis::ExtendedModel found = diagnosis::ReadModel(options.model, input.JointEffects());
  const diagnosis::EffectMakers joints =
      input.held ? input.held->EffectsFrom(found.start_ns) : diagnosis::EffectMakers{};
  diagnosis::ExtendedInstrument model(found, recording, joints);
  return EstimateRecording(diagnosis::WithoutLatency(recording, found, joints), estimator, &model,
                           update);
}

/// Where the window says the port is, at the end.
nlohmann::json WindowJson(const WindowEstimate& window) {
  const Eigen::Vector3d& shift = window.port_shift_m;
  const Eigen::Vector3d sd = window.port_covariance_m2.diagonal().cwiseMax(0.0).cwiseSqrt();
  return {{"samples", window.samples},
          {"status", Name(window.status)},
          {"port_shift_m", {shift.x(), shift.y(), shift.z()}},
          {"port_sd_m", {sd.x(), sd.y(), sd.z()}},
          {"least_known_sd_m", window.least_known_sd_m}};
}

/// Scoring only, where the simulation left its truth: each sample's tip as an observation.
std::optional<TipScore> ScoreAgainstTruth(const std::filesystem::path& recording,
                                          const Estimates& estimates) {
  const auto truth = ReadTipTruth(recording, {});
  if (!truth) return {};
  Series<TipObservation> tips;
  for (const auto& estimate : estimates) {
    if (estimate.value.status != EstimateStatus::kOk) continue;
    tips.push_back({estimate.t_ns,
                    {TipStatus::kOk, estimate.value.p_RE, estimate.value.p_RE_covariance_m2, {}}});
  }
  return ScoreTips(tips, *truth, Pose());
}

nlohmann::json Summary(const EstimateOptions& options, const Recording& recording,
                       const Estimates& estimates, const EstimateTotals& totals,
                       const WindowEstimate* window) {
  nlohmann::json statuses = nlohmann::json::object();
  const auto count = [&](EstimateStatus status, int samples) {
    if (samples > 0) statuses[Name(status)] = samples;
  };
  count(EstimateStatus::kOk, totals.ok);
  count(EstimateStatus::kUnobservable, totals.unobservable);
  count(EstimateStatus::kNotConverged, totals.not_converged);
  count(EstimateStatus::kBadInput, totals.bad_input);
  nlohmann::json sensors = nlohmann::json::array();
  const auto present = [&](bool is, const char* name) {
    if (is) sensors.push_back(name);
  };
  present(recording.wrist0.has_value(), "wrist0");
  present(recording.vision0.has_value(), "vision0");
  present(recording.em0.has_value(), "em0");
  present(recording.em1.has_value(), "em1");
  present(recording.strain0.has_value(), "strain0");
  present(recording.load0.has_value(), "load0");
  nlohmann::json summary = {
      {"samples", estimates.size()}, {"statuses", statuses}, {"sensors", sensors}};
  if (!options.model.empty()) summary["model"] = options.model.filename().string();
  if (window != nullptr) summary["window"] = WindowJson(*window);
  if (totals.chi2_per_measurement > 0.0) {
    summary["chi2_per_measurement"] = totals.chi2_per_measurement;
  }
  if (totals.ok > 0) {
    summary["tip_sd_m"] = totals.tip_sd_m;
    summary["force_across_sd_N"] = totals.force_across_sd_N;
    summary["force_along_sd_N"] = totals.force_along_sd_N;
  }
  const auto score = ScoreAgainstTruth(options.input.recording, estimates);
  if (score && score->frames > 0) {
    summary["scored_samples"] = score->frames;
    summary["tip_rms_error_m"] = score->RmsError();
    summary["tip_mean_nees"] = score->MeanNees();
  }
  return summary;
}

void RunEstimate(const EstimateOptions& options, bool quiet) {
  const ShaftInput input = ReadShaft(options.input, UseOfEstimate(), quiet, !options.model.empty());
  const InputRead& read = input.read;
  const Recording& recording = read.recording;
  if (!recording.wrist0) {
    throw InputError(options.input.recording.string() +
                     ": no wrist0, without which nothing can be estimated");
  }
  std::vector<std::filesystem::path> inputs = options.input.Files();
  if (!options.model.empty()) inputs.push_back(options.model);
  OutputFolder output(options.input.out, "estimate",
                      {.force = options.force, .inputs = inputs, .paths = options.input.Paths()});
  output.Warn(read.warnings);
  output.Beware(FindingsJson(read.findings));
  if (recording.cam0 && !recording.vision0) {
    output.Warn("cam0 has not been tracked: run flextip track and pass its folder with --tracked");
  }
  InstrumentEstimator estimator(MakeOptions(recording, options), options.window_samples);
  const Estimates estimates = EstimateAll(input, options, estimator, quiet);
  if (estimates.empty())
    throw WorkError(options.input.recording.string() + ": no sample could be estimated");
  CsvWriter csv(kColumns);
  for (const auto& e : estimates) AddRow(csv, e.t_ns, e.value);
  WriteTextFile(output.folder() / "state0" / "data.csv", csv.text());
  report::WriteFigures(output.folder() / "figures.json", EstimateFigures(recording, estimates));
  const EstimateTotals totals = TotalsOf(estimates);
  Judgement judged = JudgeEstimates(totals);
  MentionFindings(read.findings, judged);
  nlohmann::json summary = Summary(options, recording, estimates, totals, estimator.Window());
  summary["verdict"] = JudgementJson(judged);
  summary["streams_not_used"] = read.NotUsed();
  if (!read.calibrations.empty()) summary["calibrations"] = CalibrationsJson(read.calibrations);
  output.WriteSummary(summary);
  report::WriteEstimateReport(output.folder());
  output.Commit();
  PrintJudgement(judged, output.paths(), quiet);
  RequireFound(judged, output.paths());
  if (quiet) return;
  if (!read.NotUsed().empty()) fmt::print("Not used: {}\n", read.NotUsed());
  fmt::print("{}\n", (options.input.out / "report.html").string());
}

}  // namespace

void AddEstimate(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand(
      "estimate", "Load, port and shape of the instrument at every sample of a recording");
  auto options = std::make_shared<EstimateOptions>();
  AddRecordingInput(*command, options->input);
  command
      ->add_option("--model", options->model,
                   "Know of the effects in this model.yaml (from flextip diagnose)")
      ->type_name("MODEL.yaml");
  AddLength(*command, "--port-prior", options->port_prior_m,
            "How well the port is registered: standard deviation per axis: 0.001 or 1mm")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--window", options->window_samples,
                   "Find the port's place from so many samples together, spread over where the "
                   "wrist was; --port-prior may then be wide (several mm)")
      ->check(CLI::Range(2, 1000))
      ->type_name("N");
  command->add_flag("--without-positions", options->without_positions,
                    "Leave out the places of tip and EM sensor, as a system without tip tracking");
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer("Example:\n  flextip estimate recording -o estimate\n");
  OnRun(*command, context, [options, &context] { RunEstimate(*options, context.quiet); });
}

}  // namespace flextip
