// The planned motion on the plant, beside the best of the library and a random one: seconds of
// motion until the hidden cause is certain.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "bench/campaign/campaign.h"
#include "bench/next_motion/trial.h"
#include "bench/tool.h"

namespace flextip::bench {
namespace {

struct Arguments {
  std::filesystem::path scenario, out;
  int trials = 20, jobs = 1;
  std::uint64_t first_seed = 1;
  bool summarize = false;
};

void AddOptions(CLI::App& app, Arguments& arguments) {
  app.add_option("scenario", arguments.scenario, "Whose instrument, sensors and first motion")
      ->required();
  app.add_option("--trials", arguments.trials, "Hidden causes")->check(CLI::PositiveNumber);
  app.add_option("--first-seed", arguments.first_seed, "Another one gives other causes");
  app.add_option("--jobs", arguments.jobs, "Trials at a time")->check(CLI::PositiveNumber);
  app.add_flag("--summarize", arguments.summarize, "Only read trials.jsonl");
  app.add_option("-o,--out", arguments.out, "Folder for trials.jsonl")->required();
  app.footer(
      "Example:\n  flextip_next_motion testdata/scenarios/tag_or_camera.yaml --trials 40 -o "
      "next\n");
}

CaseResult RunCase(const Arguments& arguments, std::size_t index) {
  const TrialRecord r = RunTrial(arguments.scenario, arguments.first_seed + index);
  std::string said = r.why;
  if (r.qualifies) said = fmt::format("{}: {}", fmt::join(r.rivals, ", "), r.seconds);
  return {TrialLine(r), fmt::format("{:<10} {:<22} {}", r.key, r.effect, said)};
}

void Run(Arguments& arguments) {
  const auto file = arguments.out / "trials.jsonl";
  if (!arguments.summarize) {
    std::filesystem::create_directories(arguments.out);
    Campaign campaign{.records = file, .jobs = arguments.jobs};
    for (int i = 0; i < arguments.trials; ++i)
      campaign.names.push_back(
          fmt::format("seed_{}", arguments.first_seed + static_cast<std::uint64_t>(i)));
    for (const TrialRecord& record : ReadTrials(file)) campaign.done.insert(record.key);
    campaign.run = [&](std::size_t index) { return RunCase(arguments, index); };
    if (!RunCampaign(campaign)) return;
  }
  fmt::print("{}", TrialTable(ReadTrials(file)));
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "How soon the planned motion tells causes apart",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
