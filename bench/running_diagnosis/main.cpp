// How soon the running diagnosis warns of what sets in, whether it names it, how often it warns of
// nothing, and what it costs.
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <filesystem>

#include "bench/running_diagnosis/cost.h"
#include "bench/running_diagnosis/table.h"
#include "bench/tool.h"
#include "recording/text/text.h"

namespace flextip::bench {
namespace {

struct Arguments {
  int runs = 10, jobs = 1;
  std::uint64_t seed = 1;
  double healthy_hours = 0.0, healthy_run_s = 300.0, run_s = 80.0, false_alarms_per_hour = 0.1;
  std::vector<std::string> causes;
  bool cost = false;
  std::filesystem::path out;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--runs", a.runs, "Runs of each cause and size")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--causes", a.causes, "Some of them; all without it")
      ->delimiter(',')
      ->check(CLI::IsMember(OnsetCauses()));
  app.add_option("--run-s", a.run_s, "Length of a run")->capture_default_str();
  app.add_option("--healthy-hours", a.healthy_hours, "Simulated hours without a cause")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--healthy-run-s", a.healthy_run_s, "Length of a healthy run")
      ->capture_default_str();
  app.add_option("--false-alarms", a.false_alarms_per_hour, "Stated, in an hour")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", a.seed, "Another one gives other runs")->capture_default_str();
  app.add_option("--jobs", a.jobs, "Runs at a time")->check(CLI::PositiveNumber);
  app.add_flag("--cost", a.cost, "Measure the time of a sample beside an estimate's");
  app.add_option("-o,--out", a.out, "Folder for onsets.csv and healthy.csv")->required();
  app.footer("Example:\n  flextip_watch_table --healthy-hours 4 --jobs 2 --cost -o watched\n");
}

std::vector<WatchedRecord> RunAll(int jobs, std::size_t count,
                                  const std::function<WatchedRun(std::size_t)>& draw) {
  std::vector<WatchedRecord> records(count);
  tbb::task_arena arena(jobs);
  arena.execute([&] {
    tbb::parallel_for(std::size_t(0), count,
                      [&](std::size_t i) { records[i] = RunWatched(draw(i)); });
  });
  return records;
}

void Run(Arguments& a) {
  std::filesystem::create_directories(a.out);
  const std::vector<std::string>& causes = a.causes.empty() ? OnsetCauses() : a.causes;
  const std::size_t of_size = causes.size() * static_cast<std::size_t>(a.runs);
  if (a.runs > 0) {
    const auto records = RunAll(a.jobs, kOnsetSizeCount * of_size, [&](std::size_t i) {
      const auto number = static_cast<int>(i % static_cast<std::size_t>(a.runs));
      const std::string& cause = causes[i % of_size / static_cast<std::size_t>(a.runs)];
      return DrawOnset(a.seed, number, cause, static_cast<int>(i / of_size), a.run_s,
                       a.false_alarms_per_hour);
    });
    WriteTextFile(a.out / "onsets.csv", CsvText(records));
    fmt::print("{}\n", OnsetTable(records));
  }
  if (a.healthy_hours > 0.0) {
    const auto count = static_cast<std::size_t>(3600.0 * a.healthy_hours / a.healthy_run_s + 0.5);
    // Numbers that no onset has.
    const auto records = RunAll(a.jobs, count, [&](std::size_t i) {
      const int number = 100'002 + static_cast<int>(i);
      return DrawWatched(a.seed, number, static_cast<Suite>(number / kMoves % kSuites),
                         a.healthy_run_s, a.false_alarms_per_hour);
    });
    WriteTextFile(a.out / "healthy.csv", CsvText(records));
    fmt::print("{}\n", HealthyTable(records));
  }
  if (a.cost) fmt::print("{}", CostText(MeasureCost(a.seed)));
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "The running diagnosis on simulated runs",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
