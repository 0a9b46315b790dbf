#include "testdata/hidden/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "recording/recording_writer.h"
#include "testdata/hidden/drawn.h"
#include "testdata/hidden/run.h"

namespace flextip::hidden {
namespace {

using Rng = std::mt19937_64;
constexpr int kAttempts = 20;
constexpr int kMotions = 5;  // tried for a further recording

bool Has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}

void CheckOptions(const HiddenOptions& options) {
  for (const std::string& name : options.left_out) {
    if (!Has({"em0", "strain0", "vision0", "wrist0_orientation"}, name)) {
      throw InputError(
          fmt::format("sensor \"{}\" cannot be left out: expected em0, strain0, "
                      "vision0 or wrist0_orientation",
                      name));
    }
  }
  const double ratio = options.tick_rate_hz / 50.0;
  if (!(ratio >= 1.0) || ratio != std::round(ratio)) {
    throw InputError(
        fmt::format("tick rate {} Hz: expected a multiple of 50 Hz", options.tick_rate_hz));
  }
  if (!(options.scene.duration_s >= 1.0 && options.scene.duration_s <= 3600.0)) {
    throw InputError(
        fmt::format("duration {} s: expected 1 s to an hour", options.scene.duration_s));
  }
}

simulation::SensorEffects MakeSensorEffects(const HiddenLabel& label, const HiddenScene& scene,
                                            const Run& run, const HiddenOptions& options,
                                            Rng& rng) {
  simulation::SensorEffects effects = simulation::EffectsOf(label.parameters).sensors;
  effects.em_centre_m = EmCentre(run, *scene.sensors.em0);
  effects.em_curvature = Uniform(rng, 0.1, 0.2);
  effects.noise_scale = options.noise_free ? 0.0 : options.noise_scale;
  effects.noise_correlation = options.noise_correlation;
  const double clipped = Uniform(rng, 0.4, 0.6);
  if (Has(label.present, "strain_clip")) {
    effects.strain_limit_Nm = clipped * HighestMoment(run, *scene.sensors.strain);
  }
  return effects;
}

/// Every sensor samples; which of them are kept is decided after, so that none changes another.
void SampleRun(const Run& run, const HiddenScene& scene, const simulation::SensorEffects& effects,
               std::uint64_t seed, HiddenRecording& hidden) {
  simulation::Sensors sensors(scene.sensors, seed, effects);
  for (std::size_t i = 0; i < run.shapes.size(); ++i) {
    const TimeNs t_ns = simulation::kSimulationStart_ns + std::llround(run.t_s[i] * 1e9);
    const simulation::PlantShape& shape = run.shapes[i];
    const std::size_t before =
        hidden.recording.wrist0 ? hidden.recording.wrist0->samples.size() : 0;
    sensors.Sample(shape, t_ns, hidden.recording);
    if (hidden.recording.wrist0 && hidden.recording.wrist0->samples.size() > before) {
      const Pose T_RE = shape.T_RE();
      hidden.truth.push_back({t_ns, {T_RE.p, T_RE.Quaternion(), shape.T_RW().p}});
    }
  }
}

void LeaveOut(const HiddenOptions& options, Recording& recording) {
  if (!options.with_load) recording.load0.reset();
  if (Has(options.left_out, "em0")) recording.em0.reset();
  if (Has(options.left_out, "strain0")) recording.strain0.reset();
  if (Has(options.left_out, "vision0")) {
    recording.vision0.reset();
    recording.cam0.reset();
  }
  if (Has(options.left_out, "wrist0_orientation")) {
    for (auto& sample : recording.wrist0->samples) sample.value.q_RW.reset();
  }
}

/// A recording of `drawn`, and what its sensors do.
HiddenRecording Sampled(const DrawnCase& drawn, const Run& run,
                        const simulation::SensorEffects& effects, std::uint64_t noise_seed,
                        const HiddenOptions& options) {
  HiddenRecording hidden;
  hidden.attempt = drawn.attempt;
  hidden.scene = drawn.scene;
  hidden.label = drawn.label;
  hidden.recording.instrument = drawn.scene.instrument;
  hidden.recording.p_RP = drawn.scene.p_RP;
  hidden.recording.gravity_m_s2 = drawn.scene.gravity_m_s2;
  hidden.recording.cam0.emplace();
  hidden.recording.cam0->comment = "laparoscope";
  hidden.recording.cam0->calibration = drawn.scene.camera;
  SampleRun(run, drawn.scene, effects, noise_seed, hidden);
  for (const HiddenForm& form : drawn.forms) form.ActOnReadings(hidden.recording);
  if (options.carrier != nullptr)
    options.carrier->Record(hidden.recording, simulation::kSimulationStart_ns);
  LeaveOut(options, hidden.recording);
  return hidden;
}

/// One recording as it was made, and what others of the same instrument need of it.
struct Made {
  HiddenRecording hidden;
  DrawnCase drawn;
  simulation::SensorEffects sensors;
};

std::optional<Made> Attempt(const HiddenOptions& options, std::uint64_t seed, int attempt) {
  const DrawnCase drawn = DrawCase(options, seed, attempt);
  const std::optional<Run> run = RunPlant(drawn.scene, drawn.plant, drawn.forms, options);
  if (!run) return {};
  Rng sensor_rng = GeneratorFor(seed, attempt, 5);
  const simulation::SensorEffects sensors =
      MakeSensorEffects(drawn.label, drawn.scene, *run, options, sensor_rng);
  return Made{Sampled(drawn, *run, sensors, sensor_rng(), options), drawn, sensors};
}

/// Recording `index` of the instrument of `first`; another motion where one has no equilibrium.
std::optional<HiddenRecording> AttemptNext(const HiddenSeries& series, std::uint64_t seed,
                                           const Made& first, int index) {
  for (int motion = 0; motion < kMotions; ++motion) {
    const DrawnCase drawn = DrawNextCase(series, seed, first.drawn, index, motion);
    const std::optional<Run> run = RunPlant(drawn.scene, drawn.plant, drawn.forms, series.options);
    if (!run) continue;
    simulation::SensorEffects sensors = simulation::EffectsOf(drawn.label.parameters).sensors;
    sensors.em_centre_m = first.sensors.em_centre_m;  // the room's field stays where it is
    sensors.em_curvature = first.sensors.em_curvature;
    sensors.strain_limit_Nm = first.sensors.strain_limit_Nm;
    sensors.noise_scale = first.sensors.noise_scale;
    sensors.noise_correlation = first.sensors.noise_correlation;
    const std::uint64_t noise_seed = GeneratorFor(seed, first.drawn.attempt, 1000 + index)();
    return Sampled(drawn, *run, sensors, noise_seed, series.options);
  }
  return {};
}

}  // namespace

HiddenRecording MakeHidden(const HiddenOptions& options, std::uint64_t seed) {
  CheckOptions(options);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (auto made = Attempt(options, seed, attempt)) return std::move(made->hidden);
  }
  throw WorkError(fmt::format("seed {}: {} draws in a row have no equilibrium", seed, kAttempts));
}

std::vector<HiddenRecording> MakeHiddenSeries(const HiddenSeries& series, std::uint64_t seed) {
  CheckOptions(series.options);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    auto first = Attempt(series.options, seed, attempt);
    if (!first) continue;
    std::vector<HiddenRecording> all;
    all.push_back(first->hidden);
    for (int index = 1; index < series.recordings; ++index) {
      auto next = AttemptNext(series, seed, *first, index);
      if (!next) break;
      all.push_back(std::move(*next));
    }
    if (static_cast<int>(all.size()) == series.recordings) return all;
  }
  throw WorkError(fmt::format("seed {}: {} draws in a row have no equilibrium", seed, kAttempts));
}

void WriteHidden(const std::filesystem::path& folder, const HiddenRecording& hidden,
                 bool with_truth) {
  if (std::filesystem::exists(folder) && !std::filesystem::is_empty(folder)) {
    throw InputError(folder.string() + ": exists and is not empty; expected a new folder");
  }
  std::filesystem::create_directories(folder);
  if (with_truth) WriteTruth(folder, hidden.truth);
  WriteRecording(folder, hidden.recording);
}

}  // namespace flextip::hidden
