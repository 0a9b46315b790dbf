// How often the diagnosis is right: hidden recordings of every effect, size and kind, each written
// to a folder without its label, read again, diagnosed, and compared. Resumes where it stopped.
#include <fmt/format.h>

#include "bench/campaign/campaign.h"
#include "bench/diagnosis_matrix/output/picture.h"
#include "bench/diagnosis_matrix/output/summary.h"
#include "bench/diagnosis_matrix/run.h"
#include "bench/tool.h"
#include "core/error.h"
#include "recording/text/text.h"

namespace flextip::bench {
namespace {

struct Arguments {
  MatrixPlan plan;
  int jobs = 1;
  bool summarize = false;
  std::filesystem::path out;
};

void AddOptions(CLI::App& app, Arguments& arguments) {
  MatrixPlan& plan = arguments.plan;
  app.add_option("--parts", plan.parts, fmt::format("{}", fmt::join(MatrixParts(), ",")))
      ->delimiter(',')
      ->check(CLI::IsMember(MatrixParts()));
  app.add_option("--sizes", plan.sizes, "subtle,plain,strong")
      ->delimiter(',')
      ->check(CLI::IsMember({"subtle", "plain", "strong"}));
  app.add_option("--loads", plan.loads, "known,unknown")
      ->delimiter(',')
      ->check(CLI::IsMember({"known", "unknown"}));
  app.add_option("--effects", plan.effects, "Of singles and leave-outs; all where not given")
      ->delimiter(',')
      ->check(CLI::IsMember(simulation::CatalogueEffects()));
  app.add_option("--seeds-per-cell", plan.seeds_per_cell, "Recordings for each cell")
      ->check(CLI::PositiveNumber);
  app.add_option("--healthy", plan.healthy, "Healthy recordings for each load")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--pairs", plan.pairs, "Random pairs for each load and size")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--triples", plan.triples, "Random three for each load and size")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--first-seed", plan.first_seed, "Another one gives other recordings");
  app.add_option("--family", plan.family, "Motions: tuning, held_out or any")
      ->check(CLI::IsMember({"tuning", "held_out", "any"}));
  app.add_option("--duration", plan.duration_s, "Seconds of each recording")
      ->check(CLI::Range(1.0, 3600.0));
  app.add_option("--noise-correlation", plan.noise_correlation,
                 "AR(1) coefficient of the sensors' noise, from sample to sample")
      ->check(CLI::Range(0.0, 0.999));
  app.add_option("--jobs", arguments.jobs, "Cases at a time")->check(CLI::PositiveNumber);
  app.add_flag("--summarize", arguments.summarize, "Only read cases.jsonl");
  app.add_option("-o,--out", arguments.out,
                 "Folder for cases.jsonl, summary.json, matrix.svg, misses.txt")
      ->required();
  app.footer(
      "Example:\n  flextip_diagnosis_matrix --parts singles,healthy --sizes subtle,plain,strong "
      "--seeds-per-cell 2 --family held_out -o matrix\n");
}

CaseResult RunCase(const MatrixCase& one) {
  const MatrixRecord r = RunMatrixCase(one);
  const bool right = r.IsRight() && r.error.empty();
  const std::string answer = !r.error.empty() ? r.error : right ? "" : JoinedNames(r.verdict);
  return {JsonLine(r), fmt::format("{:<70} {}{}  p {:.3f}  {:.2f} s", r.key, right ? "ok" : "MISS ",
                                   answer, r.p_truth, r.seconds)};
}

bool RunCases(const Arguments& arguments, const std::filesystem::path& file) {
  const std::vector<MatrixCase> cases = PlanMatrix(arguments.plan);
  Campaign campaign{.records = file, .jobs = arguments.jobs};
  for (const MatrixCase& one : cases) campaign.names.push_back(one.Key());
  for (const MatrixRecord& record : ReadRecords(file)) campaign.done.insert(record.key);
  campaign.run = [&](std::size_t index) { return RunCase(cases[index]); };
  return RunCampaign(campaign);
}

void Summarize(const std::filesystem::path& out) {
  const std::vector<MatrixRecord> records = ReadRecords(out / "cases.jsonl");
  if (records.empty()) throw InputError((out / "cases.jsonl").string() + ": holds no cases");
  const auto figures = Figures(records);
  const auto main = Confusions(records), leave_outs = LeaveOutConfusions(records);
  auto all = main;
  all.insert(all.end(), leave_outs.begin(), leave_outs.end());
  WriteTextFile(out / "summary.json", SummaryJson(figures, all));
  WriteTextFile(out / "misses.txt", Misses(records));
  if (!main.empty()) {
    WriteTextFile(out / "matrix.svg", ConfusionSvg(main, "What was hidden and what was answered"));
  }
  if (!leave_outs.empty()) {
    WriteTextFile(out / "leave_outs.svg",
                  ConfusionSvg(leave_outs, "With a sensor or the true effect left out"));
  }
  fmt::print("{}", FigureTable(figures));
}

void Run(Arguments& arguments) {
  if (!arguments.summarize) {
    std::filesystem::create_directories(arguments.out);
    if (!RunCases(arguments, arguments.out / "cases.jsonl")) return;
  }
  Summarize(arguments.out);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "How often the diagnosis finds what is hidden",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
