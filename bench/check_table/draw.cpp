#include "bench/check_table/draw.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "bench/check_table/vary.h"
#include "simulation/closed_loop/scenario.h"
#include "testdata/broken/broken_recording.h"
#include "testdata/hidden/recording.h"

namespace flextip::bench {
namespace {

using Rng = std::mt19937_64;

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}

template <class T>
const T& Pick(Rng& rng, const std::vector<T>& from) {
  return from[std::uniform_int_distribution<std::size_t>(0, from.size() - 1)(rng)];
}

/// Noise stated as it is, within a third.
double About(Rng& rng, double sd) { return sd * std::exp(Uniform(rng, -0.7, 0.7)); }

void DrawSensors(simulation::SensorSetup& sensors, Rng& rng) {
  const std::vector<double> rates{30.0, 60.0, 100.0, 120.0, 200.0};
  const std::vector<double> tip_rates{15.0, 25.0, 30.0, 60.0};
  if (sensors.wrist) {
    sensors.wrist->rate_hz = Pick(rng, rates);
    sensors.wrist->position_noise_m = About(rng, sensors.wrist->position_noise_m);
  }
  if (sensors.em0) {
    sensors.em0->rate_hz = Pick(rng, rates);
    sensors.em0->distance_from_tip_m = Uniform(rng, 0.005, 0.06);
    sensors.em0->position_noise_m = About(rng, 3e-4);
    sensors.em0->orientation_noise_rad = About(rng, 2e-3);
    if (Uniform(rng, 0.0, 1.0) < 0.5) sensors.em0->noise_distribution = NoiseDistribution::kUniform;
  }
  if (sensors.strain) sensors.strain->rate_hz = Pick(rng, rates);
  if (sensors.tip) sensors.tip->rate_hz = Pick(rng, tip_rates);
}

}  // namespace

HealthyCase DrawOpenLoop(std::uint64_t seed) {
  Rng rng(seed);
  hidden::HiddenOptions options;
  options.scene.family = hidden::MotionFamily::kAny;
  options.scene.duration_s = Uniform(rng, 8.0, 30.0);
  options.tick_rate_hz = Uniform(rng, 0.0, 1.0) < 0.3 ? 100.0 : 50.0;
  options.links_per_side = 30;
  options.drawn_effects = std::uniform_int_distribution<int>(0, 2)(rng);
  const std::vector<hidden::EffectSize> sizes{
      hidden::EffectSize::kSubtle, hidden::EffectSize::kPlain, hidden::EffectSize::kStrong};
  options.size = Pick(rng, sizes);
  if (Uniform(rng, 0.0, 1.0) < 0.2) options.effects = {Pick(rng, hidden::OtherForms())};
  const std::vector<std::vector<std::string>> left_out{{},
                                                       {},
                                                       {"em0"},
                                                       {"strain0"},
                                                       {"vision0"},
                                                       {"em0", "strain0"},
                                                       {"strain0", "vision0"},
                                                       {"wrist0_orientation"}};
  options.left_out = Pick(rng, left_out);
  options.with_load = Uniform(rng, 0.0, 1.0) < 0.8;
  options.noise_scale = Uniform(rng, 0.6, 1.6);
  if (Uniform(rng, 0.0, 1.0) < 0.3) options.noise_correlation = Uniform(rng, 0.3, 0.9);
  const hidden::HiddenRecording hidden = hidden::MakeHidden(options, seed);
  HealthyCase drawn;
  drawn.recording = hidden.recording;
  drawn.hung_mass = hidden.scene.load.kind == hidden::LoadKind::kHungMass;
  if (Uniform(rng, 0.0, 1.0) < 0.7) broken::AddFurtherStreams(drawn.recording, rng);
  drawn.name = fmt::format("open loop {}, {}, load {}, effects {}; {}", seed,
                           Name(hidden.scene.motion_setup.kind), Name(hidden.scene.load.kind),
                           fmt::join(hidden.label.present, " "), Vary(drawn.recording, rng));
  return drawn;
}

HealthyCase DrawClosedLoop(std::uint64_t seed) {
  Rng rng(seed);
  const std::vector<std::string> files{"press.yaml", "direction.yaml", "fixtures.yaml"};
  const std::string& file = Pick(rng, files);
  const auto folder = std::filesystem::path(FLEXTIP_SOURCE_DIR) / "testdata" / "scenarios";
  simulation::Scenario scenario = simulation::ReadScenario(folder / file);
  simulation::LoopSetup& loop = scenario.loop;
  loop.seed = seed;
  loop.controller.kind = Pick(rng, scenario.controllers);
  DrawSensors(loop.sensors, rng);
  loop.plant.instrument.bending_stiffness_Nm2 *= Uniform(rng, 0.8, 1.25);
  HealthyCase drawn;
  drawn.recording = simulation::RunClosedLoop(loop, nullptr).recording;
  drawn.name = fmt::format("closed loop {}, {}, {}; {}", seed, file, Name(loop.controller.kind),
                           Vary(drawn.recording, rng));
  return drawn;
}

HealthyCase DrawHealthy(std::uint64_t seed) {
  return seed % 4 == 3 ? DrawClosedLoop(seed) : DrawOpenLoop(seed);
}

}  // namespace flextip::bench
