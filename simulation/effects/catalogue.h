// The effects of docs/effects.md by their names: parameters, neutral values, place in the
// simulation.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/instrument.h"
#include "simulation/plant/effects.h"
#include "simulation/sensors/effects.h"

namespace flextip::simulation {

struct InstrumentEffects {
  PlantEffects plant;
  SensorEffects sensors;
};

/// Parameter name -> values, matrices by rows.
using EffectParameters = std::map<std::string, std::vector<double>>;
/// Effect name -> its parameters.
using EffectValues = std::map<std::string, EffectParameters>;

/// One row of the catalogue.
struct EffectParameter {
  std::string_view effect, name;
  std::span<const double> neutral;  ///< the values that have no effect
  /// Writes the values, as many as `neutral` has, to their place in plant or sensors.
  void (*set)(std::span<const double> values, InstrumentEffects& effects);
};

/// The effects' names, in the order of the catalogue.
const std::vector<std::string>& CatalogueEffects();

/// The neutral values of every parameter of every effect.
const EffectValues& NeutralEffects();

/// Returns the row of a parameter. Throws std::out_of_range for a name that is not in the
/// catalogue.
const EffectParameter& FindEffectParameter(std::string_view effect, std::string_view parameter);

/// Returns the effects of `values`, neutral where nothing is given. The mass per length is the part
/// beyond the nominal mass. Throws InputError, without a file's name, for an unknown effect or
/// parameter or a wrong count of numbers.
InstrumentEffects EffectsOf(const EffectValues& values);

/// The same, with the whole mass per length of the shaft in `values`: the part beyond
/// `nominal.mass_per_length_kg_m` acts as effect.
InstrumentEffects EffectsOfWholeMass(EffectValues values, const Instrument& nominal);

}  // namespace flextip::simulation
