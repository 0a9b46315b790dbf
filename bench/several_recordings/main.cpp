// What several recordings of one instrument together tell: pairs of causes that one cannot
// separate, changes between two, and models on a recording that was not fitted.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>

#include "bench/campaign/campaign.h"
#include "bench/several_recordings/run.h"
#include "bench/several_recordings/table.h"
#include "bench/tool.h"

namespace flextip::bench {
namespace {

struct Arguments {
  std::map<std::string, int> counts{{"pairs", 0}, {"changes", 0}, {"healthy", 0}, {"predict", 0}};
  double duration_s = 20.0;
  std::uint64_t first_seed = 1;
  int jobs = 1;
  bool summarize = false;
  std::filesystem::path out;
};

void AddOptions(CLI::App& app, Arguments& arguments) {
  for (auto& [part, count] : arguments.counts)
    app.add_option("--" + part, count, "Series that are drawn for this part")
        ->check(CLI::NonNegativeNumber);
  app.add_option("--duration", arguments.duration_s, "Seconds of each recording")
      ->check(CLI::Range(2.0, 3600.0));
  app.add_option("--first-seed", arguments.first_seed, "Another one gives other series");
  app.add_option("--jobs", arguments.jobs, "Cases at a time")->check(CLI::PositiveNumber);
  app.add_flag("--summarize", arguments.summarize, "Only read cases.jsonl");
  app.add_option("-o,--out", arguments.out, "Folder for cases.jsonl")->required();
  app.footer(
      "Example:\n  flextip_several_table --pairs 40 --changes 40 --healthy 20 --jobs 2 "
      "-o several\n");
}

CaseResult RunCase(const SeveralCase& one) {
  const SeveralRecord r = RunSeveralCase(one);
  std::string said = !r.error.empty() ? r.error : "does not qualify";
  if (r.qualifies && r.error.empty()) {
    said = one.part == "predict"
               ? fmt::format("{:.3f} of {:.3f}", r.ratio, r.ratio_of_own_fit)
               : fmt::format("{} {} {} {:.1f} s", r.IsRight() ? "ok   " : "MISS ",
                             fmt::join(r.verdict, "+"), fmt::join(r.changes, " "), r.seconds);
  }
  return {SeveralLine(r),
          fmt::format("{:<32} {:<20} begin {}  {}", r.key, r.effect, r.begin, said)};
}

void Run(Arguments& arguments) {
  const auto file = arguments.out / "cases.jsonl";
  if (!arguments.summarize) {
    std::filesystem::create_directories(arguments.out);
    std::vector<SeveralCase> cases;
    for (const auto& [part, count] : arguments.counts)
      for (int i = 0; i < count; ++i)
        cases.push_back({part, i, arguments.duration_s, arguments.first_seed});
    Campaign campaign{.records = file, .jobs = arguments.jobs};
    for (const SeveralCase& one : cases) campaign.names.push_back(one.Key());
    for (const SeveralRecord& record : ReadSeveral(file)) campaign.done.insert(record.key);
    campaign.run = [&](std::size_t index) { return RunCase(cases[index]); };
    if (!RunCampaign(campaign)) return;
  }
  fmt::print("{}", SeveralTable(ReadSeveral(file)));
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "What several recordings together tell",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
