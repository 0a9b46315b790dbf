// flextip diagnose: what the simulation gets wrong, why, and what an extended model gains.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
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
#include "apps/diagnose/held.h"
#include "apps/diagnose/motion_options.h"
#include "apps/diagnose/rank_helpers.h"
#include "apps/diagnose/result_files.h"
#include "core/error.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/judge_diagnosis.h"
#include "diagnosis/model/extended_model.h"
#include "diagnosis/several/diagnose_several.h"
#include "recording/join.h"
#include "report/pages.h"
#include "simulation/closed_loop/gain.h"

namespace flextip {
namespace {

struct Options {
  RecordingInput input;
  std::vector<std::filesystem::path> others;  ///< recordings after the first
  std::vector<std::string> without;
  MotionOptions plan;
  bool one_session = false, no_closed_loop = false, force = false;
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

/// A recording as it was read, under its name.
struct NamedRead : ShaftInput {
  std::string name;
};

/// Names of the folders, made unique.
std::string UniqueName(const std::filesystem::path& folder, const std::vector<NamedRead>& taken) {
  const std::filesystem::path full = std::filesystem::absolute(folder).lexically_normal();
  const std::string name =
      (full.has_filename() ? full.filename() : full.parent_path().filename()).string();
  std::string unique = name;
  const auto is_taken = [&] {
    return std::ranges::any_of(taken, [&](const NamedRead& one) { return one.name == unique; });
  };
  for (int count = 2; is_taken(); ++count) unique = fmt::format("{}_{}", name, count);
  return unique;
}

std::vector<NamedRead> ReadAll(const Options& options, bool quiet) {
  if (!options.input.tracked.empty() && !options.others.empty()) {
    throw InputError("--tracked is of one recording, found several: put the tips into each");
  }
  std::vector<std::filesystem::path> folders{options.input.recording};
  folders.insert(folders.end(), options.others.begin(), options.others.end());
  std::vector<NamedRead> all;
  for (const std::filesystem::path& folder : folders) {
    RecordingInput input = options.input;
    input.recording = folder;
    const std::string name = UniqueName(folder, all);
    all.push_back({ReadShaft(input, UseOfDiagnose(), quiet), name});
  }
  return all;
}

OutputFolder OutputOf(const Options& options) {
  std::vector<std::filesystem::path> inputs = options.input.Files();
  inputs.insert(inputs.end(), options.others.begin(), options.others.end());
  return {options.input.out,
          "diagnose",
          {.force = options.force, .inputs = inputs, .paths = options.input.Paths()}};
}

nlohmann::json SummaryOf(const diagnosis::DiagnosisResult& result) {
  nlohmann::json summary = {{"verdicts", result.verdict},
                            {"samples", result.samples},
                            {"fits", result.fits},
                            {"probability", result.probabilities.front().probability},
                            {"converged", result.converged}};
  if (result.gain.measured) summary["heldout_error_ratio"] = result.gain.heldout_error_ratio;
  return summary;
}

void Finish(const Options& options, const std::vector<NamedRead>& reads, const Judgement& judged,
            nlohmann::json summary, OutputFolder& output, bool quiet) {
  const InputRead& first = reads.front().read;
  summary["streams_not_used"] = first.NotUsed();
  if (!first.calibrations.empty()) summary["calibrations"] = CalibrationsJson(first.calibrations);
  summary["verdict"] = JudgementJson(judged);
  output.WriteSummary(summary);
  report::WriteDiagnoseReport(output.folder());
  output.Commit();
  PrintJudgement(judged, output.paths(), quiet);
  RequireFound(judged, output.paths());
  if (quiet) return;
  if (!first.NotUsed().empty()) fmt::print("Not used: {}\n", first.NotUsed());
  fmt::print("{}\n", (options.input.out / "report.html").string());
}

std::optional<simulation::ClosedLoopGain> GainOf(const Options& options, const Recording& recording,
                                                 const diagnosis::DiagnosisResult& result,
                                                 OutputFolder& output) {
  if (options.no_closed_loop || !diagnosis::NamesEffects(result.verdict)) return {};
  return MeasureGain(recording, diagnosis::FromResult(result), output);
}

diagnosis::DiagnoseOptions DiagnoseOptionsOf(const Options& options) {
  return {.without = options.without, .plan = options.plan.Limits()};
}

void RunOne(const Options& options, const std::vector<NamedRead>& reads, bool quiet) {
  const InputRead& read = reads.front().read;
  OutputFolder output = OutputOf(options);
  output.Warn(read.warnings);
  output.Beware(FindingsJson(read.findings));
  const diagnosis::DiagnoseOptions diagnose = DiagnoseOptionsOf(options);
  const std::string name = options.input.recording.string();
  diagnosis::DiagnosisResult result;
  if (reads.front().held) {
    result = DiagnoseHeldShaft(reads.front(), name, diagnose, output.folder());
  } else {
    result = diagnosis::Diagnose(read.recording, name, diagnose);
    const auto gain = GainOf(options, read.recording, result, output);
    WriteDiagnosisFiles(output.folder(), DiagnosisJson(result, gain ? &*gain : nullptr), result);
  }
  output.Warn(result.warnings);
  Judgement judged = diagnosis::JudgeDiagnosis(result);
  MentionFindings(read.findings, judged);
  Finish(options, reads, judged, SummaryOf(result), output, quiet);
}

std::vector<diagnosis::NamedRecording> RecordingsOf(const std::vector<NamedRead>& reads) {
  std::vector<diagnosis::NamedRecording> recordings;
  recordings.reserve(reads.size());
  for (const NamedRead& one : reads) recordings.push_back({one.name, one.read.recording});
  return recordings;
}

void RunSeveral(const Options& options, const std::vector<NamedRead>& reads, bool quiet,
                const diagnosis::Helpers& helpers) {
  OutputFolder output = OutputOf(options);
  std::vector<plausibility::Finding> findings;
  for (const NamedRead& one : reads) {
    for (const std::string& warning : one.read.warnings) output.Warn(one.name + ": " + warning);
    findings.insert(findings.end(), one.read.findings.begin(), one.read.findings.end());
  }
  const std::vector<diagnosis::NamedRecording> recordings = RecordingsOf(reads);
  output.Beware(FindingsJson(findings));
  const diagnosis::SeveralResult several =
      diagnosis::DiagnoseSeveral(recordings, DiagnoseOptionsOf(options), helpers);
  output.Warn(several.common.warnings);
  const auto gain = GainOf(options, recordings.front().recording, several.common, output);
  WriteDiagnosisFiles(output.folder(), DiagnosisJson(several, gain ? &*gain : nullptr),
                      several.common);
  nlohmann::json summary = SummaryOf(several.common);
  summary["recordings"] = several.names;
  summary["changes"] = several.changes.size();
  tbb::parallel_for(std::size_t{0}, several.own.size(), [&](std::size_t r) {
    const auto folder = output.folder() / "recordings" / several.names[r];
    WriteDiagnosisFiles(folder, DiagnosisJson(several.own[r]), several.own[r]);
  });
  Judgement judged = diagnosis::JudgeSeveral(several);
  MentionFindings(findings, judged);
  Finish(options, reads, judged, summary, output, quiet);
}

/// The stretches of one session as one recording, with the warnings of all.
std::vector<NamedRead> Joined(std::vector<NamedRead> reads) {
  const std::vector<diagnosis::NamedRecording> named = RecordingsOf(reads);
  std::vector<const Recording*> stretches;
  stretches.reserve(reads.size());
  diagnosis::RequireOneSession(named);
  for (const diagnosis::NamedRecording& one : named) stretches.push_back(&one.recording);
  InputRead& first = reads.front().read;
  first.recording = Join(stretches);
  for (std::size_t i = 1; i < reads.size(); ++i) {
    for (const std::string& warning : reads[i].read.warnings)
      first.warnings.push_back(reads[i].name + ": " + warning);
    first.findings.insert(first.findings.end(), reads[i].read.findings.begin(),
                          reads[i].read.findings.end());
  }
  reads.resize(1);
  return reads;
}

void RequireNotHeld(const std::vector<NamedRead>& reads) {
  for (const NamedRead& one : reads) {
    if (reads.size() > 1 && one.held) {
      throw InputError(one.name +
                       ": an arm holds the shaft (joints0), expected such a recording alone");
    }
  }
}

void RunArm(const Options& options, bool quiet) {
  if (options.one_session) throw InputError("--one-session is of shafts, found an arm");
  ArmRun run{{options.input.recording}, options.input.out, options.without, options.force, quiet};
  run.closed_loop = !options.no_closed_loop;
  run.recordings.insert(run.recordings.end(), options.others.begin(), options.others.end());
  DiagnoseArm(run);
}

void RunHere(const Options& options, bool quiet, const diagnosis::Helpers& helpers) {
  if (IsArmRecording(options.input.recording)) return RunArm(options, quiet);
  std::vector<NamedRead> reads = ReadAll(options, quiet);
  RequireNotHeld(reads);
  if (options.one_session) reads = Joined(std::move(reads));
  reads.size() == 1 ? RunOne(options, reads, quiet) : RunSeveral(options, reads, quiet, helpers);
}

void Run(const Options& options, bool quiet) {
  if (!RanksShareTheWork()) return RunHere(options, quiet, {});
  const RankHelpers ranks;
  if (ranks.IsFirst()) return RunHere(options, quiet, ranks.Ask());
  Options silent = options;  // the first rank says what the check finds
  silent.input.silent = true;
  ranks.Serve(DiagnoseOptionsOf(options), [&] { return RecordingsOf(ReadAll(silent, true)); });
}

}  // namespace

void AddDiagnose(CLI::App& app, AppContext& context) {
  auto* command = app.add_subcommand(
      "diagnose", "What the simulation gets wrong, why, and what an extended model gains");
  auto options = std::make_shared<Options>();
  AddRecordingInput(*command, options->input);
  command
      ->add_option("others", options->others,
                   "More recordings of the same instrument, in order of time: judged together")
      ->type_name("RECORDING");
  command
      ->add_option("--without", options->without,
                   "Effects to leave out of the catalogue (once for each)")
      ->type_name("EFFECT");
  command->add_flag("--no-closed-loop", options->no_closed_loop,
                    "Do not run the controllers with and without the model on a simulated plant "
                    "that has what was found");
  command->add_flag("--one-session", options->one_session,
                    "The recordings were made one right after the other, with nothing taken apart "
                    "or registered in between: diagnosed as one");
  AddMotionOptions(*command, options->plan);
  command->add_flag("--force", options->force, "Replace the folder of an earlier run");
  command->footer(
      "Example:\n  flextip diagnose recording -o diagnosis\n"
      "  flextip diagnose recording --plan-motion --plan-speed 0.05 -o diagnosis\n"
      "  flextip diagnose monday tuesday friday -o week\n"
      "  flextip diagnose first second --one-session -o session\n"
      "  mpirun -n 8 flextip diagnose week_* -o weeks\n");
  OnRun(*command, context, [options, &context] { Run(*options, context.quiet); });
}

}  // namespace flextip
