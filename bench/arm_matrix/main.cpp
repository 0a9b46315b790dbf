// How often an arm's diagnosis is right: arms that move by forces in time, with what is wrong with
// them hidden. Resumes where it stopped.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "arms/diagnose/diagnose.h"
#include "bench/arm_matrix/draw.h"
#include "bench/arm_matrix/loop.h"
#include "bench/campaign/campaign.h"
#include "bench/tool.h"

namespace flextip::bench {
namespace {

using Json = nlohmann::json;

struct Arguments {
  std::map<std::string, int> counts{
      {"single", 0}, {"pair", 0}, {"healthy", 0}, {"deleted", 0}, {"form", 0}};
  std::uint64_t first_seed = 1;
  int jobs = 1;
  bool loop = false, summarize = false;
  std::filesystem::path out;
};

void AddOptions(CLI::App& app, Arguments& a) {
  for (auto& [part, count] : a.counts)
    app.add_option("--" + part, count, "Arms of this part")->check(CLI::NonNegativeNumber);
  app.add_option("--first-seed", a.first_seed, "Another one gives other arms");
  app.add_option("--jobs", a.jobs, "Cases at a time")->check(CLI::PositiveNumber);
  app.add_flag("--loop", a.loop, "Move each arm by what was found of it, too");
  app.add_flag("--summarize", a.summarize, "Only read cases.jsonl");
  app.add_option("-o,--out", a.out, "Folder for cases.jsonl")->required();
  app.footer("Example:\n  flextip_arm_matrix --single 108 --pair 36 --healthy 60 -o arms\n");
}

/// Right: what was hidden and nothing else; what the catalogue lacks is unknown.
bool IsRight(const ArmCase& one, const HiddenArm& hidden, const diagnosis::Verdict& verdict) {
  const std::set<std::string> said(verdict.begin(), verdict.end());
  if (one.part == "healthy") return said == std::set<std::string>{"none"};
  if (one.part == "deleted" || one.part == "form") return said == std::set<std::string>{"unknown"};
  return said == hidden.effects;
}

CaseResult RunCase(const ArmCase& one, bool with_loop) {
  const HiddenArm hidden = Draw(one);
  arms::ArmOptions options;
  if (one.part == "deleted") options.without.assign(hidden.effects.begin(), hidden.effects.end());
  const arms::ArmData data(RecordingOf(hidden), "hidden");
  const auto begin = std::chrono::steady_clock::now();
  const arms::ArmResult result = Diagnose({data}, options);
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const auto& answer = result.answer;
  const bool right = IsRight(one, hidden, answer.verdict);
  Json json{{"part", one.part},
            {"number", one.number},
            {"effects", hidden.effects},
            {"size", hidden.size},
            {"sensors", hidden.sensors},
            {"verdict", answer.verdict},
            {"probability", answer.probabilities.front().probability},
            {"right", right},
            {"heldout_ratio", answer.gain.heldout_error_ratio},
            {"seconds", seconds}};
  if (with_loop && one.part != "form") {
    const ArmLoop loop = RunArmLoop(hidden, result.model);
    json["loop"] = {{"before_rms", loop.before},
                    {"after_rms", loop.after},
                    {"tip_before_m", loop.tip_before_m},
                    {"tip_after_m", loop.tip_after_m}};
  }
  return {json.dump(), fmt::format("{} {:<12} {} {} {}: {} {:.2f} {:.1f} s",
                                   right ? "ok  " : "MISS", one.Name(), hidden.size, hidden.sensors,
                                   fmt::join(hidden.effects, "+"), fmt::join(answer.verdict, "+"),
                                   answer.probabilities.front().probability, seconds)};
}

struct Count {
  int cases = 0, right = 0;
};

/// What is left of the tip's error by what was found, a kind each.
void PrintLoops(const std::map<std::string, std::vector<std::array<double, 2>>>& loops) {
  if (loops.empty()) return;
  fmt::print(
      "\n| hidden | arms | tip before (mm) | after | left: middle | worst |\n"
      "|---|---|---|---|---|---|\n");
  for (const auto& [name, tips] : loops) {
    std::vector<double> before, after, left;
    for (const auto& [b, a] : tips) {
      before.push_back(1e3 * b);
      after.push_back(1e3 * a);
      left.push_back(a / b);
    }
    for (auto* list : {&before, &after, &left}) std::sort(list->begin(), list->end());
    const std::size_t middle = tips.size() / 2;
    fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", name, tips.size(),
               before[middle], after[middle], left[middle], left.back());
  }
}

void Summarize(const std::filesystem::path& file) {
  std::map<std::string, Count> by_part, by_effect, by_sensors;
  std::map<std::string, std::vector<std::array<double, 2>>> loops;
  std::vector<double> seconds;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const Json r = Json::parse(line);
    const auto count = [&](Count& c) {
      ++c.cases;
      c.right += r.at("right").get<bool>();
    };
    const std::string part = r.at("part"), size = r.at("size");
    count(by_part[size.empty() ? part : fmt::format("{}, {}", part, size)]);
    seconds.push_back(r.at("seconds"));
    if (r.contains("loop")) {
      const std::string kind =
          part == "single" ? r.at("effects")[0].get<std::string>() : "part: " + part;
      loops[kind].push_back({r["loop"].at("tip_before_m"), r["loop"].at("tip_after_m")});
    }
    if (part != "single") continue;
    count(by_effect[r.at("effects")[0]]);
    count(by_sensors[r.at("sensors")]);
  }
  const auto table = [](const char* head, const std::map<std::string, Count>& counts) {
    fmt::print("\n| {} | right |\n|---|---|\n", head);
    for (const auto& [name, c] : counts) fmt::print("| {} | {} of {} |\n", name, c.right, c.cases);
  };
  table("part", by_part);
  table("single, effect", by_effect);
  table("single, sensors", by_sensors);
  PrintLoops(loops);
  if (seconds.empty()) return;
  std::sort(seconds.begin(), seconds.end());
  fmt::print("\nSeconds: {:.1f} in the middle, {:.1f} at most.\n", seconds[seconds.size() / 2],
             seconds.back());
}

void Run(Arguments& a) {
  const auto file = a.out / "cases.jsonl";
  if (!a.summarize) {
    std::filesystem::create_directories(a.out);
    std::vector<ArmCase> cases;
    Campaign campaign{.records = file, .jobs = a.jobs};
    for (const auto& [part, count] : a.counts)
      for (int i = 0; i < count; ++i) {
        cases.push_back({part, i, a.first_seed});
        campaign.names.push_back(cases.back().Name());
      }
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      const Json r = Json::parse(line);
      campaign.done.insert(ArmCase{r.at("part"), r.at("number"), a.first_seed}.Name());
    }
    campaign.run = [&](std::size_t i) { return RunCase(cases[i], a.loop); };
    if (!RunCampaign(campaign)) return;
  }
  Summarize(file);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "How often an arm's diagnosis is right",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
