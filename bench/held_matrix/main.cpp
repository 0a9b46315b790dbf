// How often the diagnosis of a shaft that an arm holds is right: an arm by forces in time carries
// the wrist of the shaft's plant, with something wrong in either or both. Resumes where it stopped.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "arms/held_shaft/diagnose_held.h"
#include "bench/campaign/campaign.h"
#include "bench/tool.h"
#include "core/error.h"
#include "recording/recording_writer.h"
#include "testdata/held_arm/arm_carrier.h"
#include "testdata/held_arm/faults.h"
#include "testdata/hidden/recording.h"

namespace flextip::bench {
namespace {

using Json = nlohmann::json;

constexpr std::array kOfArm{"joint_offset",    "joint_scale", "joint_coupling", "joint_backlash",
                            "command_latency", "servo_lag",   "link_geometry",  "joint_compliance"};
constexpr std::array kOfShaft{"stiffness",  "port_offset", "tag_offset",
                              "em_latency", "strain_gain", "precurvature"};
constexpr double kPlain = 18.0;  // tolerances, of an arm's effect
constexpr double kSeconds = 20.0;

struct Arguments {
  std::map<std::string, int> counts{{"healthy", 0}, {"arm", 0}, {"shaft", 0}, {"both", 0}};
  std::uint64_t first_seed = 1;
  int jobs = 1;
  bool summarize = false, keep = false;
  std::filesystem::path out;
};

void AddOptions(CLI::App& app, Arguments& a) {
  for (auto& [part, count] : a.counts)
    app.add_option("--" + part, count, "Recordings with that wrong")->check(CLI::NonNegativeNumber);
  app.add_option("--first-seed", a.first_seed, "Another one gives other recordings");
  app.add_option("--jobs", a.jobs, "Cases at a time")->check(CLI::PositiveNumber);
  app.add_flag("--keep", a.keep, "Write the recordings, too, without a word of what is in them");
  app.add_flag("--summarize", a.summarize, "Only read cases.jsonl");
  app.add_option("-o,--out", a.out, "Folder for cases.jsonl")->required();
  app.footer(
      "Example:\n  flextip_held_matrix --healthy 12 --arm 16 --shaft 12 --both 24 -o held\n");
}

struct Case {
  std::string part;
  int number = 0;
  std::uint64_t first_seed = 1;
  std::string Name() const { return fmt::format("{} {}", part, number); }
};

/// What is wrong in one, and how it was recorded: every other one without wrist0.
struct Hidden {
  std::set<std::string> effects;
  Recording recording;
  bool has_wrist = true;
};

Hidden Draw(const Case& one, std::uint64_t attempt) {
  std::seed_seq seeds{one.first_seed, std::uint64_t(one.part[0]), std::uint64_t(one.number),
                      attempt};
  std::mt19937_64 rng(seeds);
  Hidden hidden;
  hidden.has_wrist = one.number % 2 == 0;
  simulation::ArmFaults faults;
  const auto pick = std::size_t(one.number / 2);
  if (one.part == "arm" || one.part == "both") {
    hidden.effects.insert(kOfArm[pick % kOfArm.size()]);
    hidden::PutFault(*hidden.effects.begin(), kPlain, rng, faults);
  }
  hidden::HiddenOptions options;
  if (one.part == "shaft" || one.part == "both") {
    // Without the wrist's orientation gages tell nothing.
    const std::size_t count = hidden.has_wrist ? kOfShaft.size() : 4;
    options.effects = {kOfShaft[one.part == "both" ? rng() % count : pick % count]};
    hidden.effects.insert(options.effects.front());
  }
  hidden::ArmCarrier carrier(simulation::SmallArm(), faults, hidden.has_wrist, rng());
  options.carrier = &carrier;
  options.scene.duration_s = kSeconds;
  options.scene.family = hidden::MotionFamily::kHeldOut;
  hidden.recording = hidden::MakeHidden(options, rng()).recording;
  return hidden;
}

/// Drawn anew where the course is beyond the arm's reach.
Hidden Draw(const Case& one) {
  constexpr std::uint64_t kAttempts = 10;
  for (std::uint64_t attempt = 0;; ++attempt) {
    try {
      return Draw(one, attempt);
    } catch (const WorkError&) {
      if (attempt + 1 == kAttempts) throw;
    }
  }
}

/// Whether each hidden effect is named, or declared as what cannot be told from an effect that is.
bool IsDeclared(const std::set<std::string>& hidden, const diagnosis::DiagnosisResult& answer) {
  const auto in = [](const auto& list, const std::string& name) {
    return std::ranges::find(list, name) != list.end();
  };
  return answer.verdict.size() == std::max<std::size_t>(1, hidden.size()) &&
         std::ranges::all_of(hidden, [&](const std::string& name) {
           return in(answer.verdict, name) ||
                  std::ranges::any_of(answer.indistinguishable, [&](const auto& group) {
                    return !group.empty() && in(answer.verdict, group.front()) && in(group, name);
                  });
         });
}

CaseResult RunCase(const Case& one, const std::filesystem::path& keep) {
  const Hidden hidden = Draw(one);
  if (!keep.empty()) {
    const auto folder = keep / fmt::format("{}_{}", one.part, one.number);
    std::filesystem::create_directories(folder);
    WriteRecording(folder, hidden.recording);
  }
  const auto begin = std::chrono::steady_clock::now();
  const arms::HeldShaft held(hidden.recording, "hidden");
  const auto answer = arms::DiagnoseHeld(held, held.WithWrist(), "hidden").answer;
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const std::set<std::string> said(answer.verdict.begin(), answer.verdict.end());
  const bool right = hidden.effects.empty() ? said.contains("none") : said == hidden.effects;
  const bool declared = right || (!hidden.effects.empty() && IsDeclared(hidden.effects, answer));
  Json json{{"part", one.part},
            {"number", one.number},
            {"effects", hidden.effects},
            {"wrist", hidden.has_wrist},
            {"verdict", answer.verdict},
            {"groups", answer.indistinguishable},
            {"probability", answer.probabilities.front().probability},
            {"right", right},
            {"declared", declared},
            {"heldout_ratio", answer.gain.heldout_error_ratio},
            {"seconds", seconds}};
  return {json.dump(), fmt::format("{} {:<10} {} {}: {} {:.2f} {:.1f} s",
                                   right      ? "ok  "
                                   : declared ? "same"
                                              : "MISS",
                                   one.Name(), hidden.has_wrist ? "wrist0" : "joints",
                                   fmt::join(hidden.effects, "+"), fmt::join(answer.verdict, "+"),
                                   answer.probabilities.front().probability, seconds)};
}

void Summarize(const std::filesystem::path& file) {
  struct Count {
    int cases = 0, right = 0, declared = 0;
  };
  std::map<std::string, Count> by_part, by_effect;
  std::vector<double> seconds;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const Json r = Json::parse(line);
    const auto count = [&](Count& c) {
      ++c.cases;
      c.right += r.at("right").get<bool>();
      c.declared += r.at("declared").get<bool>();
    };
    count(by_part[fmt::format("{}, {}", r.at("part").get<std::string>(),
                              r.at("wrist").get<bool>() ? "wrist0" : "joints alone")]);
    seconds.push_back(r.at("seconds"));
    for (const Json& effect : r.at("effects")) count(by_effect[effect]);
  }
  for (const auto* counts : {&by_part, &by_effect}) {
    fmt::print("\n| hidden | right | right, or declared |\n|---|---|---|\n");
    for (const auto& [name, c] : *counts)
      fmt::print("| {} | {} of {} | {} |\n", name, c.right, c.cases, c.declared);
  }
  if (seconds.empty()) return;
  std::ranges::sort(seconds);
  fmt::print("\nSeconds: {:.1f} in the middle, {:.1f} at most.\n", seconds[seconds.size() / 2],
             seconds.back());
}

void Run(Arguments& a) {
  const auto file = a.out / "cases.jsonl";
  if (!a.summarize) {
    std::filesystem::create_directories(a.out);
    std::vector<Case> cases;
    Campaign campaign{.records = file, .jobs = a.jobs};
    for (const auto& [part, count] : a.counts)
      for (int i = 0; i < count; ++i) {
        cases.push_back({part, i, a.first_seed});
        campaign.names.push_back(cases.back().Name());
      }
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      const Json r = Json::parse(line);
      campaign.done.insert(Case{r.at("part"), r.at("number"), a.first_seed}.Name());
    }
    campaign.run = [&](std::size_t i) {
      return RunCase(cases[i], a.keep ? a.out / "recordings" : "");
    };
    if (!RunCampaign(campaign)) return;
  }
  Summarize(file);
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv,
                                 "How often the diagnosis of a shaft that an arm holds is right",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
