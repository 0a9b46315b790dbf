#include "testdata/hidden/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "recording/recording_writer.h"
#include "simulation/plant/plant.h"
#include "testdata/hidden/forms.h"

namespace flextip::hidden {
namespace {

using Rng = std::mt19937_64;
constexpr int kAttempts = 20;
constexpr double kLeadIn_s = 0.5;  // friction, play and latency have a past

bool Has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
}

/// One generator for each purpose, from seed and attempt.
Rng Generator(std::uint64_t seed, int attempt, int purpose) {
  std::seed_seq sequence{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(attempt),
                         std::uint32_t(purpose)};
  return Rng(sequence);
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

/// Whether the sensor an effect acts on alone is there.
bool CanShow(const std::string& effect, const HiddenOptions& options) {
  const std::string sensor = SensorOf(effect);
  return sensor == "load0" ? options.with_load : !Has(options.left_out, sensor);
}

std::vector<std::string> PresentEffects(const HiddenOptions& options, Rng& rng) {
  std::vector<std::string> present = options.effects, candidates;
  for (const std::string& name : simulation::CatalogueEffects()) {
    if (!Has(present, name) && CanShow(name, options)) candidates.push_back(name);
  }
  std::shuffle(candidates.begin(), candidates.end(), rng);
  for (int i = 0; i < options.drawn_effects && i < static_cast<int>(candidates.size()); ++i) {
    present.push_back(candidates[i]);
  }
  return present;
}

/// What the plant was at every tick, from the lead-in on.
struct Run {
  std::vector<double> t_s;
  std::vector<simulation::PlantShape> shapes;
};

simulation::PlantSetup MakePlantSetup(const HiddenScene& scene,
                                      const simulation::PlantEffects& effects) {
  simulation::PlantSetup setup;
  setup.instrument = scene.instrument;
  setup.p_RP = scene.p_RP;
  setup.weight_N_m = scene.instrument.mass_per_length_kg_m * scene.gravity_m_s2;
  setup.load = scene.load.At(-kLeadIn_s);
  setup.roll_rad = scene.RollAt(-kLeadIn_s);
  setup.gravity_m_s2 = scene.gravity_m_s2;
  setup.effects = effects;
  return setup;
}

/// Empty where the plant loses its equilibrium, or bends as no instrument is bent.
std::optional<Run> RunPlant(const HiddenScene& scene, const simulation::PlantSetup& setup,
                            const std::vector<HiddenForm>& forms, const HiddenOptions& options) {
  simulation::Plant plant(setup, {options.links_per_side, options.links_per_side});
  const WristCourse motion = scene.Motion();
  Run run;
  const int lead_in = static_cast<int>(std::lround(kLeadIn_s * options.tick_rate_hz));
  const int ticks = static_cast<int>(std::lround(scene.duration_s * options.tick_rate_hz));
  for (int tick = -lead_in; tick < ticks; ++tick) {
    const double t = tick / options.tick_rate_hz;
    plant.SetLoad(scene.load.At(t));
    plant.SetRoll(scene.RollAt(t));
    for (const HiddenForm& form : forms) {
      if (!form.IsOfPlant()) continue;
      simulation::PlantEffects effects;
      form.ActOnPlant(t, setup.effects, effects);
      plant.SetEffects(effects);
    }
    run.t_s.push_back(t);
    run.shapes.push_back(plant.Solve(motion.At(t), t));
    const simulation::PlantShape& shape = run.shapes.back();
    constexpr double kMostTurn = 0.3;  // cosine of the turn from wrist to tip
    if (!shape.IsUsable()) return {};
    if (shape.Tangent(0.0).dot(shape.Tangent(shape.length_m)) < kMostTurn) return {};
  }
  return run;
}

/// The middle of the places where the EM sensor was while it was recorded.
Eigen::Vector3d EmCentre(const Run& run, const EmStream& em) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < run.shapes.size(); ++i) {
    if (run.t_s[i] < 0) continue;
    sum += run.shapes[i].Position(run.shapes[i].length_m - em.distance_from_tip_m);
    ++count;
  }
  return sum / count;
}

double HighestMoment(const Run& run, const StrainStream& strain) {
  double highest = 0.0;
  for (const simulation::PlantShape& shape : run.shapes) {
    for (const double s : strain.station_from_wrist_m) {
      const Eigen::Vector3d local = shape.Frame(s).R.transpose() * shape.Moment(s);
      highest = std::max(highest, local.tail<2>().cwiseAbs().maxCoeff());
    }
  }
  return highest;
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

std::optional<HiddenRecording> Attempt(const HiddenOptions& options, std::uint64_t seed,
                                       int attempt) {
  const auto generator = [&](int purpose) { return Generator(seed, attempt, purpose); };
  Rng scene_rng = generator(1), choice_rng = generator(2), effect_rng = generator(3),
      form_rng = generator(4), sensor_rng = generator(5);
  HiddenRecording hidden;
  hidden.attempt = attempt;
  hidden.scene = DrawScene(options.scene, scene_rng);
  const HiddenScene& scene = hidden.scene;
  EffectDraw draw;
  draw.present = PresentEffects(options, choice_rng);
  draw.size = options.size;
  draw.exact = options.exact;
  draw.massless = scene.instrument.mass_per_length_kg_m == 0.0;
  draw.mean_axis = scene.motion_setup.axis;
  hidden.label = DrawEffects(draw, effect_rng);
  simulation::PlantEffects effects = simulation::EffectsOf(hidden.label.parameters).plant;
  effects.wrist_reading.about_m = scene.Motion().At(0.0);  // where the recording begins
  effects.port_motion.second_harmonic = Uniform(form_rng, 0.1, 0.2);
  for (const std::string& form : draw.present) AddShaftForm(form, scene, form_rng, effects);

  std::vector<HiddenForm> forms;
  for (const std::string& form : draw.present)
    if (Has(LaterForms(), form)) forms.emplace_back(form, scene, form_rng);
  const std::optional<Run> run = RunPlant(scene, MakePlantSetup(scene, effects), forms, options);
  if (!run) return {};
  const simulation::SensorEffects sensor_effects =
      MakeSensorEffects(hidden.label, scene, *run, options, sensor_rng);
  hidden.recording.instrument = scene.instrument;
  hidden.recording.p_RP = scene.p_RP;
  hidden.recording.gravity_m_s2 = scene.gravity_m_s2;
  hidden.recording.cam0.emplace();
  hidden.recording.cam0->comment = "laparoscope";
  hidden.recording.cam0->calibration = scene.camera;
  SampleRun(*run, scene, sensor_effects, sensor_rng(), hidden);
  for (const HiddenForm& form : forms) form.ActOnReadings(hidden.recording);
  LeaveOut(options, hidden.recording);
  return hidden;
}

}  // namespace

HiddenRecording MakeHidden(const HiddenOptions& options, std::uint64_t seed) {
  CheckOptions(options);
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (auto hidden = Attempt(options, seed, attempt)) return std::move(*hidden);
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
