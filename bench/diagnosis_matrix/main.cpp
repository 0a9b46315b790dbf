// How often the diagnosis is right: hidden recordings of every effect, size and kind, each written
// to a folder without its label, read again, diagnosed, and compared. Resumes where it stopped.
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <thread>

#include "batch/line_file.h"
#include "batch/run.h"
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

std::vector<MatrixCase> NotDoneYet(const MatrixPlan& plan, const std::filesystem::path& file) {
  std::set<std::string> done;
  for (const MatrixRecord& r : ReadRecords(file)) done.insert(r.key);
  std::vector<MatrixCase> cases = PlanMatrix(plan);
  const std::size_t all = cases.size();
  std::erase_if(cases, [&](const MatrixCase& one) { return done.contains(one.Key()); });
  fmt::print("{} cases, {} of them done before\n", all, all - cases.size());
  return cases;
}

/// The record's line, and behind it the line for the terminal.
int RunCase(const MatrixCase& one, std::size_t threads, std::string& payload) {
  const tbb::global_control share(tbb::global_control::max_allowed_parallelism, threads);
  const MatrixRecord record = RunMatrixCase(one);
  payload = JsonLine(record) + "\n" +
            fmt::format("{:<70} {}{}  p {:.3f}  {:.2f} s", record.key,
                        record.IsRight() && record.error.empty() ? "ok" : "MISS ",
                        record.error.empty() ? (record.IsRight() ? "" : JoinedNames(record.verdict))
                                             : record.error,
                        record.p_truth, record.seconds);
  return 0;
}

/// A case that crashed or threw has no line in the file: it is done again when the tool goes on.
void RunCases(const std::vector<MatrixCase>& cases, int jobs, const std::filesystem::path& file) {
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t threads = std::max<std::size_t>(1, cores / static_cast<std::size_t>(jobs));
  std::vector<batch::Item> items;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    items.push_back({cases[i].Key(), {std::to_string(i)}, 0.0});
  }
  batch::Pool pool(
      [&](const batch::Item& item, std::string& payload) {
        return RunCase(cases[std::stoul(item.arguments[0])], threads, payload);
      },
      {.jobs = jobs});
  batch::LineFile lines(file);
  int written = 0, lost = 0;
  batch::RunItems(pool, items, [&](const std::vector<batch::Ended>& ended) {
    std::vector<std::string> records;
    for (const batch::Ended& one : ended) {
      const std::string& payload = one.outcome.payload;
      const std::size_t end = payload.find('\n');
      if (one.outcome.status == batch::Status::kOk) {
        records.push_back(payload.substr(0, end));
        fmt::print("{:>5}  {}\n", ++written, payload.substr(end + 1));
      } else {
        fmt::print("{:>5}  {:<70} {}  {}\n", "", one.outcome.name, StatusText(one.outcome),
                   payload);
        ++lost;
      }
    }
    lines.Append(records);
    std::fflush(stdout);
  });
  if (lost > 0) throw WorkError(fmt::format("{} cases did not come to an end", lost));
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
    const std::filesystem::path file = arguments.out / "cases.jsonl";
    RunCases(NotDoneYet(arguments.plan, file), arguments.jobs, file);
  }
  Summarize(arguments.out);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "How often the diagnosis finds what is hidden",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
