// How often the diagnosis finds what has no name: forms by physics that neither the catalogue nor
// the library of forms was written from, healthy recordings, named effects, and effects whose name
// was taken out of the catalogue.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench/discovery/judge.h"
#include "bench/tool.h"
#include "core/median.h"
#include "recording/text/text.h"
#include "simulation/effects/catalogue.h"

namespace flextip::bench {
namespace {

struct Arguments {
  std::vector<std::string> parts = {"forms", "healthy", "named", "deleted"}, only;
  int seeds = 1, healthy = 10;
  std::uint64_t first_seed = 1;
  bool no_load = false, held_out = false;
  std::string out;
};

void AddOptions(CLI::App& app, Arguments& arguments) {
  app.add_option("--parts", arguments.parts, "forms, healthy, named, deleted")->delimiter(',');
  app.add_option("--only", arguments.only, "Forms or effects, in place of all")->delimiter(',');
  app.add_option("--seeds", arguments.seeds, "Recordings of each form or effect");
  app.add_option("--healthy", arguments.healthy, "Healthy recordings");
  app.add_option("--first-seed", arguments.first_seed, "The others count on");
  app.add_flag("--no-load", arguments.no_load, "Leave out load0");
  app.add_flag("--held-out", arguments.held_out, "Motions that tuning never saw");
  app.add_option("-o,--output", arguments.out, "A file for the records (JSON lines)")->required();
  app.footer("Example:\n  flextip_discovery_matrix --parts forms --seeds 2 -o forms.jsonl\n");
}

std::vector<DiscoveryCase> Plan(const Arguments& arguments) {
  std::vector<DiscoveryCase> cases;
  const auto add = [&](const std::string& part, const std::string& name, int count) {
    const auto& only = arguments.only;
    if (!name.empty() && !only.empty() && std::find(only.begin(), only.end(), name) == only.end())
      return;
    for (int i = 0; i < count; ++i) {
      DiscoveryCase one{part, name, arguments.first_seed + std::uint64_t(i), {}};
      if (!name.empty()) one.options.effects = {name};
      one.options.with_load = !arguments.no_load;
      one.options.scene.family =
          arguments.held_out ? hidden::MotionFamily::kHeldOut : hidden::MotionFamily::kTuning;
      if (part == "healthy") one.seed += 1000;
      cases.push_back(one);
    }
  };
  for (const std::string& part : arguments.parts) {
    if (part == "healthy") add(part, "", arguments.healthy);
    if (part == "forms")
      for (const auto& truth : hidden::FormTruths())
        if (!truth.needs_load || !arguments.no_load) add(part, truth.name, arguments.seeds);
    if (part == "named" || part == "deleted")
      for (const std::string& effect : simulation::CatalogueEffects())
        if (hidden::SensorOf(effect) != "load0" || !arguments.no_load)
          add(part, effect, arguments.seeds);
  }
  return cases;
}

nlohmann::json Json(const DiscoveryRecord& r) {
  return {{"part", r.made.part},
          {"name", r.made.name},
          {"seed", r.made.seed},
          {"verdict", r.verdict},
          {"text", r.text},
          {"error", r.error},
          {"separation", r.separation},
          {"terms", r.terms},
          {"channel", r.channel},
          {"form", r.form},
          {"variable", r.variable},
          {"alias", r.alias},
          {"heldout_over_true", r.heldout_over_true},
          {"seconds", r.seconds}};
}

/// "7 of 9".
template <class Is>
std::string Share(const std::vector<DiscoveryRecord>& records, const std::string& part, Is is,
                  bool apart = false) {
  int yes = 0, all = 0;
  for (const auto& r : records) {
    if (r.made.part != part || !r.error.empty() || (apart && !r.IsApart())) continue;
    ++all;
    yes += is(r);
  }
  return fmt::format("{} of {}", yes, all);
}

void Run(Arguments& arguments) {
  std::vector<DiscoveryRecord> records;
  std::string lines;
  for (const DiscoveryCase& one : Plan(arguments)) {
    const DiscoveryRecord r = RunDiscovery(one);
    fmt::print("{:8} {:20} {:3} {:24} {}{}{} {:7.1f} {:5.2f} {:5.1f} s  {}{}\n", one.part, one.name,
               one.seed, r.verdict, r.channel ? 'c' : '-', r.form ? 'f' : '-',
               r.variable ? 'v' : '-', std::min(r.separation, 99999.0), r.heldout_over_true,
               r.seconds, r.text, r.error);
    std::fflush(stdout);
    lines += Json(r).dump() + "\n";
    records.push_back(r);
    WriteTextFile(arguments.out, lines);
  }
  using R = DiscoveryRecord;
  const auto found = [](const R& r) { return r.terms > 0; };
  fmt::print("\nforms apart from all known:\n");
  fmt::print("  unknown, or a term of the right channel: {}\n",
             Share(
                 records, "forms", [](const R& r) { return r.IsHonest(); }, true));
  fmt::print("  channel right: {}\n",
             Share(
                 records, "forms", [](const R& r) { return r.channel; }, true));
  fmt::print("  form and variable right: {}\n",
             Share(
                 records, "forms", [](const R& r) { return r.variable; }, true));
  fmt::print(
      "  held-out error within 1.15 of the true model's: {}\n",
      Share(
          records, "forms",
          [](const R& r) { return r.heldout_over_true > 0 && r.heldout_over_true < 1.15; }, true));
  fmt::print("false discoveries: healthy {}, named {}\n", Share(records, "healthy", found),
             Share(records, "named", found));
  fmt::print(
      "effect deleted: unknown, a term or a declared alias: {}\n",
      Share(records, "deleted", [](const R& r) { return r.unknown || r.terms > 0 || r.alias; }));
}

}  // namespace
}  // namespace flextip::bench

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "What has no name, found or not",
                                 flextip::bench::AddOptions, flextip::bench::Run);
}
