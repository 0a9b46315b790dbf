#include "testdata/hidden/drawn.h"

#include <algorithm>
#include <numbers>

namespace flextip::hidden {
namespace {

using Rng = std::mt19937_64;

bool Has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

double Uniform(Rng& rng, double from, double to) {
  return std::uniform_real_distribution<double>(from, to)(rng);
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

HiddenLabel LabelOf(const HiddenOptions& options, const HiddenScene& scene, Rng& rng,
                    const std::vector<std::string>& present) {
  EffectDraw draw;
  draw.present = present;
  draw.size = options.size;
  draw.exact = options.exact;
  draw.massless = scene.instrument.mass_per_length_kg_m == 0.0;
  draw.mean_axis = scene.motion_setup.axis;
  return DrawEffects(draw, rng);
}

/// `place`: where forms outside the catalogue are.
simulation::PlantEffects PlantOf(const HiddenLabel& label, const HiddenScene& scene,
                                 const HiddenScene& place, Rng& form_rng) {
  simulation::PlantEffects effects = simulation::EffectsOf(label.parameters).plant;
  effects.wrist_reading.about_m = scene.Motion().At(0.0);  // where the recording begins
  effects.port_motion.second_harmonic = Uniform(form_rng, 0.1, 0.2);
  for (const std::string& form : label.present) AddShaftForm(form, place, form_rng, effects);
  return effects;
}

std::vector<HiddenForm> FormsOf(const HiddenLabel& label, const HiddenScene& place, Rng& form_rng) {
  std::vector<HiddenForm> forms;
  for (const std::string& form : label.present)
    if (Has(LaterForms(), form)) forms.emplace_back(form, place, form_rng);
  return forms;
}

}  // namespace

/// One generator for each purpose, from seed and attempt.
Rng GeneratorFor(std::uint64_t seed, int attempt, int purpose) {
  std::seed_seq sequence{std::uint32_t(seed), std::uint32_t(seed >> 32), std::uint32_t(attempt),
                         std::uint32_t(purpose)};
  return Rng(sequence);
}

DrawnCase DrawCase(const HiddenOptions& options, std::uint64_t seed, int attempt) {
  const auto generator = [&](int purpose) { return GeneratorFor(seed, attempt, purpose); };
  Rng scene_rng = generator(1), choice_rng = generator(2), effect_rng = generator(3),
      form_rng = generator(4);
  DrawnCase drawn;
  drawn.attempt = attempt;
  drawn.scene = DrawScene(options.scene, scene_rng);
  drawn.label = LabelOf(options, drawn.scene, effect_rng, PresentEffects(options, choice_rng));
  drawn.plant = PlantOf(drawn.label, drawn.scene, drawn.scene, form_rng);
  drawn.forms = FormsOf(drawn.label, drawn.scene, form_rng);
  return drawn;
}

DrawnCase DrawNextCase(const HiddenSeries& series, std::uint64_t seed, const DrawnCase& first,
                       int index, int motion) {
  const auto generator = [&](int purpose) { return GeneratorFor(seed, first.attempt, purpose); };
  Rng scene_rng = generator(100 + 10 * index + motion), effect_rng = generator(3),
      form_rng = generator(4);
  std::vector<std::string> present = first.label.present;
  if (index >= series.begin) {
    present.insert(present.end(), series.later.begin(), series.later.end());
  }
  DrawnCase drawn;
  drawn.attempt = first.attempt;
  drawn.label = LabelOf(series.options, first.scene, effect_rng, present);
  drawn.scene = WithOtherMotion(first.scene, series.options.scene, scene_rng);
  for (const char* periodic : {"port_motion", "em_interference"}) {
    drawn.label.parameters[periodic]["phase_rad"] = {
        Uniform(scene_rng, 0.0, 2.0 * std::numbers::pi)};
  }
  drawn.plant = PlantOf(drawn.label, drawn.scene, first.scene, form_rng);
  drawn.forms = FormsOf(drawn.label, first.scene, form_rng);
  return drawn;
}

}  // namespace flextip::hidden
