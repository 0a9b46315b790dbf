// Makes recordings whose effect is hidden, for the diagnosis's matrix: folders rec_0000, ...
// without a word of what is in them, and the labels in one file elsewhere.
#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>

#include "bench/tool.h"
#include "core/error.h"
#include "recording/text/text.h"
#include "testdata/held_arm/arm_carrier.h"
#include "testdata/held_arm/faults.h"
#include "testdata/hidden/recording.h"

namespace flextip::hidden {
namespace {

struct Arguments {
  HiddenOptions options;
  std::vector<std::string> effects;
  std::uint64_t seed = 1;
  int count = 1;
  bool no_load = false, truth = false;
  int recordings = 1, begin = 1;
  std::vector<std::string> later, arm;
  bool no_wrist = false;
  std::filesystem::path out, label;
};

const std::map<std::string, EffectSize> kSizes = {{"subtle", EffectSize::kSubtle},
                                                  {"plain", EffectSize::kPlain},
                                                  {"strong", EffectSize::kStrong}};
const std::map<std::string, MotionFamily> kFamilies = {{"tuning", MotionFamily::kTuning},
                                                       {"held_out", MotionFamily::kHeldOut},
                                                       {"any", MotionFamily::kAny}};

std::map<std::string, MotionKind> MotionNames() {
  std::map<std::string, MotionKind> names;
  for (const MotionKind kind : Kinds(MotionFamily::kAny)) names[Name(kind)] = kind;
  return names;
}

std::map<std::string, LoadKind> LoadNames() {
  std::map<std::string, LoadKind> names;
  for (int i = 0; i < kLoadKinds; ++i) names[Name(LoadKind(i))] = LoadKind(i);
  return names;
}

nlohmann::json Json(const simulation::EffectParameters& parameters) {
  nlohmann::json json;
  for (const auto& [name, values] : parameters) {
    if (values.size() == 1) {
      json[name] = values[0];
    } else {
      json[name] = values;
    }
  }
  return json;
}

nlohmann::json Json(const HiddenRecording& hidden, std::uint64_t seed) {
  nlohmann::json json = {{"seed", seed},
                         {"motion", Name(hidden.scene.motion_setup.kind)},
                         {"load", Name(hidden.scene.load.kind)},
                         {"attempt", hidden.attempt},
                         {"effects", nlohmann::json::object()},
                         {"others", nlohmann::json::object()}};
  for (const std::string& name : hidden.label.present) {
    json["effects"][name] = nlohmann::json::object();
  }
  for (const auto& [name, parameters] : hidden.label.parameters) {
    json[json["effects"].contains(name) ? "effects" : "others"][name] = Json(parameters);
  }
  return json;
}

void AddOptions(CLI::App& app, Arguments& arguments) {
  HiddenOptions& options = arguments.options;
  app.add_option("--seed", arguments.seed, "Of the first recording; the next ones count on");
  app.add_option("--count", arguments.count, "How many recordings")->check(CLI::PositiveNumber);
  app.add_option("--effects", arguments.effects,
                 "Names with commas between (docs/effects.md, port_grip, taper, shaft_tissue, "
                 "second_contact, strain_clip), none, or draw1, draw2, draw3")
      ->delimiter(',');
  app.add_option("--size", options.size, "subtle, plain or strong")
      ->transform(CLI::CheckedTransformer(kSizes));
  app.add_flag("--exact", options.exact, "Nothing but the effects is off");
  app.add_flag("--no-load", arguments.no_load, "Leave out load0");
  app.add_option("--leave-out", options.left_out, "em0, strain0, vision0, wrist0_orientation")
      ->delimiter(',');
  app.add_option("--family", options.scene.family, "Motions: tuning, held_out or any")
      ->transform(CLI::CheckedTransformer(kFamilies));
  app.add_option("--motion", options.scene.motion, "One kind of motion")
      ->transform(CLI::CheckedTransformer(MotionNames()));
  app.add_option("--load", options.scene.load, "none, hung_mass, tissue or varying")
      ->transform(CLI::CheckedTransformer(LoadNames()));
  app.add_option("--duration", options.scene.duration_s, "Seconds");
  app.add_option("--noise-scale", options.noise_scale, "True noise over the stated one")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--noise-correlation", options.noise_correlation,
                 "AR(1) coefficient from sample to sample")
      ->check(CLI::Range(0.0, 0.999));
  app.add_option("--recordings", arguments.recordings,
                 "Of each instrument, with motions of their own: rec_0000_0, rec_0000_1, ...")
      ->check(CLI::PositiveNumber);
  app.add_option("--later", arguments.later, "Effects that begin with recording --begin")
      ->delimiter(',');
  app.add_option("--begin", arguments.begin, "Counted from 0")->check(CLI::PositiveNumber);
  app.add_option(
         "--arm", arguments.arm,
         "An arm of three joints carries the wrist, with these effects of 18 tolerances, or "
         "none; joints0 and joints_command0 are written")
      ->delimiter(',');
  app.add_flag("--no-wrist", arguments.no_wrist, "With --arm: leave out wrist0");
  app.add_flag("--truth", arguments.truth, "Write truth0 too");
  app.add_option("-o,--output", arguments.out, "Folder for rec_0000, rec_0001, ...")->required();
  app.add_option("--label", arguments.label, "File for the labels, outside that folder")
      ->required();
  app.footer(
      "Example:\n  flextip_make_hidden --seed 7 --count 20 --effects stiffness,em_latency "
      "--size plain --family held_out -o recordings --label labels.json\n");
}

/// none and draw1 to draw3 are not names of effects.
void TakeEffects(Arguments& arguments) {
  for (const std::string& name : arguments.effects) {
    if (name == "draw1" || name == "draw2" || name == "draw3") {
      arguments.options.drawn_effects = name.back() - '0';
    } else if (name != "none") {
      arguments.options.effects.push_back(name);
    }
  }
  arguments.options.with_load = !arguments.no_load;
}

bool LiesIn(const std::filesystem::path& file, const std::filesystem::path& folder) {
  const auto relative = std::filesystem::weakly_canonical(file).lexically_relative(
      std::filesystem::weakly_canonical(folder));
  return !relative.empty() && *relative.begin() != "..";
}

/// One that an arm carries, where that was asked for.
HiddenRecording MakeOne(const Arguments& arguments, std::uint64_t seed) {
  if (arguments.arm.empty()) return MakeHidden(arguments.options, seed);
  constexpr double kTolerances = 18.0;
  std::mt19937_64 rng(seed);
  simulation::ArmFaults faults;
  for (const std::string& effect : arguments.arm)
    if (effect != "none") PutFault(effect, kTolerances, rng, faults);
  ArmCarrier carrier(simulation::SmallArm(), faults, !arguments.no_wrist, rng());
  HiddenOptions options = arguments.options;
  options.carrier = &carrier;
  HiddenRecording hidden = MakeHidden(options, seed);
  for (const std::string& effect : arguments.arm)
    if (effect != "none") hidden.label.present.push_back(effect);
  return hidden;
}

void Run(Arguments& arguments) {
  TakeEffects(arguments);
  if (!arguments.arm.empty() && arguments.recordings > 1)
    throw InputError("--arm is of single recordings, found --recordings");
  if (LiesIn(arguments.label, arguments.out)) {
    throw InputError(arguments.label.string() + ": labels belong outside " +
                     arguments.out.string());
  }
  const auto start = std::chrono::steady_clock::now();
  nlohmann::json labels;
  for (int i = 0; i < arguments.count; ++i) {
    const std::uint64_t seed = arguments.seed + static_cast<std::uint64_t>(i);
    const std::string name = fmt::format("rec_{:04}", i);
    if (arguments.recordings > 1) {
      const auto all = MakeHiddenSeries(
          {arguments.options, arguments.recordings, arguments.later, arguments.begin}, seed);
      for (std::size_t r = 0; r < all.size(); ++r) {
        const std::string own = fmt::format("{}_{}", name, r);
        WriteHidden(arguments.out / own, all[r], arguments.truth);
        labels[own] = Json(all[r], seed);
      }
      continue;
    }
    const HiddenRecording hidden = MakeOne(arguments, seed);
    WriteHidden(arguments.out / name, hidden, arguments.truth);
    labels[name] = Json(hidden, seed);
  }
  WriteTextFile(arguments.label, labels.dump(1) + "\n");
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  fmt::print("{} recordings, {:.2f} s each\n", arguments.count, seconds.count() / arguments.count);
}

}  // namespace
}  // namespace flextip::hidden

int main(int argc, char** argv) {
  return flextip::bench::RunTool(argc, argv, "Recordings whose effect is hidden",
                                 flextip::hidden::AddOptions, flextip::hidden::Run);
}
