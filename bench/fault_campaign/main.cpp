// What faults do to the closed loop, and what a supervisor makes of them, judged by the truth.
// Resumes where it stopped.
#include <fmt/format.h>

#include "bench/campaign/campaign.h"
#include "bench/fault_campaign/picture.h"
#include "bench/fault_campaign/run.h"
#include "bench/fault_campaign/summary.h"
#include "bench/fault_campaign/trace.h"
#include "bench/tool.h"
#include "recording/text/text.h"

namespace flextip::bench {
namespace {

constexpr int kRunsOfACase = 250;
constexpr double kHealthyBatch_s = 1800.0;
constexpr int kHealthyNumbers = 10000;  // run numbers of a case of healthy hours

struct Arguments {
  int runs = 1000, jobs = 1;
  std::uint64_t first_seed = 1;
  double healthy_hours = 0.0;
  std::vector<std::string> supervision{"all"};
  bool summarize = false;
  std::vector<int> traces, healthy_traces;
  std::filesystem::path out;
};

void AddOptions(CLI::App& app, Arguments& a) {
  app.add_option("--runs", a.runs, "Faulted runs, each under every kind of supervision")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--healthy-hours", a.healthy_hours, "Simulated hours without fault, of each kind")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--first-seed", a.first_seed, "Another one gives other runs")
      ->capture_default_str();
  app.add_option("--supervision", a.supervision,
                 "all, or some of none, rate-limits, fixed-thresholds, full")
      ->delimiter(',')
      ->check(CLI::IsMember({"all", "none", "rate-limits", "fixed-thresholds", "full"}));
  app.add_option("--jobs", a.jobs, "Cases at a time")->check(CLI::PositiveNumber);
  app.add_flag("--summarize", a.summarize, "Only read what was done");
  app.add_option(
         "--trace", a.traces,
         "Only these runs, cycle by cycle, under the strictest kind asked for: run_N.csv, .svg")
      ->delimiter(',');
  app.add_option("--trace-healthy", a.healthy_traces, "The same of healthy runs")->delimiter(',');
  app.add_option("-o,--out", a.out,
                 "Folder for cases.jsonl, healthy.jsonl, table.csv, figures.json, hazards.svg and "
                 "worst.svg")
      ->required();
  app.footer(
      "Example:\n  flextip_fault_campaign --runs 2000 --healthy-hours 10 --jobs 2 -o faults\n");
}

std::vector<SupervisionKind> KindsOf(const Arguments& a) {
  std::vector<SupervisionKind> kinds;
  for (const char* name : {"none", "rate-limits", "fixed-thresholds", "full"}) {
    for (const std::string& asked : a.supervision)
      if (asked == "all" || asked == name) kinds.push_back(*SupervisionKindNamed(name));
  }
  return kinds;
}

CaseResult RunFaultCase(const Arguments& a, const std::string& name, int first) {
  Twins twins;
  std::vector<FaultRecord> records;
  int hazards = 0;
  for (int number = first; number < std::min(first + kRunsOfACase, a.runs); ++number) {
    for (FaultRecord& record : RunFault(DrawRun(a.first_seed, number), KindsOf(a), twins)) {
      hazards += record.hazard != "none";
      records.push_back(std::move(record));
    }
  }
  return {JsonLine(name, records),
          fmt::format("{}: {} hazards in {} runs", name, hazards, records.size())};
}

bool RunFaults(const Arguments& a) {
  Campaign campaign{.records = a.out / "cases.jsonl", .jobs = a.jobs};
  for (int first = 0; first < a.runs; first += kRunsOfACase)
    campaign.names.push_back(fmt::format("runs from {}", first));
  for (const FaultCase& done : ReadFaultCases(campaign.records)) campaign.done.insert(done.name);
  campaign.run = [&](std::size_t index) {
    return RunFaultCase(a, campaign.names[index], kRunsOfACase * static_cast<int>(index));
  };
  return RunCampaign(campaign);
}

bool RunHours(const Arguments& a) {
  Campaign campaign{.records = a.out / "healthy.jsonl", .jobs = a.jobs};
  const double all_s = 3600.0 * a.healthy_hours;
  for (int i = 0; i * kHealthyBatch_s < all_s; ++i)
    campaign.names.push_back(fmt::format("healthy {}", i));
  for (const HealthyBatch& one : ReadHealthyBatchs(campaign.records))
    campaign.done.insert(one.name);
  campaign.run = [&](std::size_t index) -> CaseResult {
    const double duration_s =
        std::min(kHealthyBatch_s, all_s - static_cast<double>(index) * kHealthyBatch_s);
    HealthyBatch one =
        RunHealthy(a.first_seed, kHealthyNumbers * static_cast<int>(index), duration_s, KindsOf(a));
    one.name = campaign.names[index];
    return {JsonLine(one), one.name};
  };
  return RunCampaign(campaign);
}

/// The worst runs once more, for their picture.
std::string WorstSvg(const Arguments& a, const std::vector<FaultRecord>& worst) {
  Twins twins;
  std::vector<Trace> traces;
  for (const FaultRecord& record : worst) {
    const auto kind = SupervisionKindNamed(record.kind);
    if (kind) traces.push_back(TraceRun(DrawRun(a.first_seed, record.number), *kind, twins));
  }
  return TracesSvg(traces);
}

void TraceRuns(const Arguments& a) {
  Twins twins;
  const auto write = [&](const char* name, const Trace& trace) {
    const std::string stem = fmt::format("{}_{}", name, trace.run.number);
    WriteTextFile(a.out / (stem + ".csv"), TraceCsv(trace));
    WriteTextFile(a.out / (stem + ".svg"), TracesSvg({trace}));
  };
  for (const int number : a.traces)
    write("run", TraceRun(DrawRun(a.first_seed, number), KindsOf(a).back(), twins));
  for (const int number : a.healthy_traces)
    write("healthy", TraceHealthyRun(a.first_seed, number, KindsOf(a).back()));
}

void Summarize(const Arguments& a) {
  std::vector<FaultRecord> records;
  for (FaultCase& one : ReadFaultCases(a.out / "cases.jsonl"))
    for (FaultRecord& record : one.records) records.push_back(std::move(record));
  const std::vector<HealthyRecord> healthy =
      JoinedHealthy(ReadHealthyBatchs(a.out / "healthy.jsonl"));
  const std::vector<KindFigures> figures = FiguresOf(records);
  WriteTextFile(a.out / "table.csv", TableText(records));
  WriteTextFile(a.out / "figures.json", FiguresJson(figures, healthy));
  WriteTextFile(a.out / "hazards.svg", HazardSvg(figures));
  const std::vector<FaultRecord> worst = Worst(records, 20);
  WriteTextFile(a.out / "worst.svg", WorstSvg(a, worst));
  if (!figures.empty()) fmt::print("{}", SummaryText(figures, worst));
  if (!healthy.empty()) fmt::print("{}", HealthyText(healthy));
}

void Run(Arguments& a) {
  if (!a.traces.empty() || !a.healthy_traces.empty()) {
    std::filesystem::create_directories(a.out);
    return TraceRuns(a);
  }
  if (!a.summarize) {
    std::filesystem::create_directories(a.out);
    if (a.runs > 0 && !RunFaults(a)) return;
    if (a.healthy_hours > 0.0 && !RunHours(a)) return;
  }
  Summarize(a);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "What faults do to the closed loop",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
