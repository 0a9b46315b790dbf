#include "apps/simulate/diagnose.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <vector>

#include "apps/common/judgement.h"
#include "apps/common/output.h"
#include "apps/common/progress.h"
#include "apps/diagnose/motion_options.h"
#include "apps/diagnose/result_files.h"
#include "apps/simulate/deviation.h"
#include "core/error.h"
#include "diagnosis/judge_diagnosis.h"
#include "diagnosis/planning/motion_file.h"
#include "recording/recording_writer.h"
#include "recording/truth.h"
#include "report/pages.h"
#include "simulation/closed_loop/diagnosing_loop.h"
#include "simulation/closed_loop/scenario_run.h"

namespace flextip {
namespace {

namespace fs = std::filesystem;
using simulation::DiagnosingEnd;
using simulation::DiagnosingResult;
using simulation::DiagnosingRound;

const char* Text(DiagnosingEnd end) {
  switch (end) {
    case DiagnosingEnd::kSeparated:
      return "no cause in the lead has a rival";
    case DiagnosingEnd::kNoMotion:
      return "no motion within the limits tells more";
    case DiagnosingEnd::kRoundsAreUp:
      return "the rounds are up";
  }
  return "";
}

simulation::Scenario Read(const DiagnosingCommand& options) {
  simulation::Scenario scenario = simulation::ReadScenario(options.scenario);
  simulation::RequireRunnable(scenario, options.scenario, false);
  simulation::RequireShort(scenario, options.scenario);
  if (scenario.controllers.size() != 1) {
    throw InputError::At(
        options.scenario.string(), 0,
        fmt::format("--diagnose moves the robot under one controller, found {} in controllers",
                    scenario.controllers.size()));
  }
  return scenario;
}

nlohmann::ordered_json RoundJson(const DiagnosingRound& round) {
  return {{"recording", round.name},          {"seconds", round.seconds},
          {"hung_weight_N", round.hung_N},    {"answer", diagnosis::Joined(round.answer)},
          {"probability", round.probability}, {"next", diagnosis::Sentence(round.next)}};
}

/// Recordings, each with the truth beside it and the motion that it made.
void WriteRounds(const fs::path& folder, const DiagnosingResult& result) {
  const diagnosis::NextMotion* made = nullptr;
  for (const DiagnosingRound& round : result.rounds) {
    WriteRecording(folder / round.name, round.run.recording);
    WriteTruth(folder / round.name, round.run.truth);
    WriteDeviation(folder / round.name / "deviation.csv", round.run);
    if (made != nullptr) diagnosis::WriteMotion(folder / round.name / "motion.yaml", *made);
    made = &round.next;
  }
}

void Print(const DiagnosingResult& result) {
  for (const DiagnosingRound& round : result.rounds) {
    fmt::print("{}, {:.1f} s{}: {} ({:.0f} %). {}\n", round.name, round.seconds,
               round.hung_N > 0.0 ? fmt::format(" with {:.2g} N at the tip", round.hung_N) : "",
               diagnosis::Joined(round.answer), 100.0 * round.probability,
               diagnosis::Sentence(round.next));
  }
  fmt::print("{:.1f} s of motion; {}\n", result.Seconds(), Text(result.end));
}

}  // namespace

CLI::Option* AddDiagnosingOptions(CLI::App& command, DiagnosingCommand& options) {
  constexpr int kMostRounds = 20;
  options.plan = std::make_shared<MotionOptions>();
  auto* diagnose =
      command.add_flag("--diagnose", options.asked,
                       "Move, diagnose, plan the next motion, move again, until the causes are "
                       "told apart: OUT/round_1, round_2, ... and their diagnosis");
  command.add_option("--rounds", options.rounds, "Motions at most, the scenario's included (4)")
      ->check(CLI::Range(1, kMostRounds))
      ->type_name("N")
      ->needs(diagnose);
  AddMotionLimits(command, *options.plan, diagnose);
  return diagnose;
}

void RunDiagnosing(const DiagnosingCommand& options, bool quiet) {
  const simulation::Scenario scenario = Read(options);
  OutputFolder output(options.out, "simulate",
                      {.force = options.force, .inputs = {options.scenario}});
  output.Warn(scenario.warnings);
  DiagnosingResult result;
  {
    Progress progress("simulate", 2 * static_cast<std::size_t>(options.rounds), quiet);
    std::size_t done = 0;
    result = simulation::DiagnoseInLoop(
        scenario, {.limits = options.plan->Within(), .most_rounds = options.rounds},
        [&](const std::string&) { progress.Update(done++); });
  }
  output.Warn(result.diagnosis.warnings);
  WriteRounds(output.folder(), result);
  WriteDiagnosisFiles(output.folder(), DiagnosisJson(result.diagnosis), result.diagnosis);
  std::vector<nlohmann::ordered_json> rounds;
  for (const DiagnosingRound& round : result.rounds) rounds.push_back(RoundJson(round));
  const Judgement judged = diagnosis::JudgeDiagnosis(result.diagnosis);
  output.WriteSummary({{"scenario", options.scenario.filename().string()},
                       {"verdicts", result.diagnosis.verdict},
                       {"rounds", rounds},
                       {"seconds_of_motion", result.Seconds()},
                       {"separated", result.end == DiagnosingEnd::kSeparated},
                       {"end", Text(result.end)},
                       {"verdict", JudgementJson(judged)}});
  report::WriteDiagnoseReport(output.folder());
  output.Commit();
  if (!quiet) Print(result);
  PrintJudgement(judged, output.paths(), quiet);
  RequireFound(judged, output.paths());
  if (!quiet) fmt::print("{}\n", (options.out / "report.html").string());
}

}  // namespace flextip
