#include "simulation/plant/instrument_effects.h"

#include <random>

#include "core/error.h"

namespace flextip::simulation {
namespace {

constexpr const char* kEmOffset = "offset_at_centre_m";

std::string Known(const hidden::EffectParameters& parameters) {
  std::string known;
  for (const auto& [name, unused] : parameters) known += (known.empty() ? "" : ", ") + name;
  return known;
}

void Take(const std::string& effect, const hidden::EffectParameters& values,
          hidden::EffectParameters& into) {
  for (const auto& [name, numbers] : values) {
    const auto at = into.find(name);
    if (at == into.end()) {
      throw InputError(
          fmt::format("{} has no parameter '{}', expected {}", effect, name, Known(into)));
    }
    if (numbers.size() != at->second.size()) {
      throw InputError(fmt::format("{}.{}: found {} numbers, expected {}", effect, name,
                                   numbers.size(), at->second.size()));
    }
    at->second = numbers;
  }
}

}  // namespace

const std::map<std::string, hidden::EffectParameters>& NeutralEffects() {
  static const std::map<std::string, hidden::EffectParameters> neutral = [] {
    hidden::EffectDraw none;
    none.exact = true;
    std::mt19937_64 rng(1);
    auto parameters = hidden::DrawEffects(none, rng).parameters;
    // Drawn even so, as they are no sizes.
    parameters["port_motion"]["frequency_hz"] = {0.25};
    parameters["port_motion"]["phase_rad"] = {0.0};
    parameters["port_moment"]["rest_axis"] = {1.0, 0.0, 0.0};
    parameters["em_distortion"][kEmOffset] = {0.0, 0.0, 0.0};
    return parameters;
  }();
  return neutral;
}

InstrumentEffects EffectsByName(const std::map<std::string, hidden::EffectParameters>& values,
                                const Instrument& nominal) {
  hidden::HiddenLabel label;
  label.parameters = NeutralEffects();
  label.parameters["self_weight"]["mass_per_length_kg_m"] = {nominal.mass_per_length_kg_m};
  for (const auto& [effect, parameters] : values) {
    const auto at = label.parameters.find(effect);
    if (at == label.parameters.end()) {
      throw InputError(fmt::format("effect '{}' is unknown, expected one of {}", effect,
                                   fmt::join(hidden::CatalogueEffects(), ", ")));
    }
    Take(effect, parameters, at->second);
  }
  label.parameters["self_weight"]["mass_per_length_kg_m"][0] -= nominal.mass_per_length_kg_m;
  InstrumentEffects effects{hidden::PlantEffectsOf(label), hidden::SensorEffectsOf(label)};
  const std::vector<double>& offset = label.parameters["em_distortion"][kEmOffset];
  effects.sensors.em_offset_m = {offset[0], offset[1], offset[2]};
  return effects;
}

}  // namespace flextip::simulation
