// Effects by the names and parameters of docs/effects.md, for plant and sensors.
#pragma once

#include <map>
#include <string>

#include "core/instrument.h"
#include "simulation/plant/effects.h"
#include "simulation/sensors/effects.h"
#include "testdata/hidden/draw.h"

namespace flextip::simulation {

struct InstrumentEffects {
  PlantEffects plant;
  SensorEffects sensors;
};

/// Values of each effect's parameters that have none: the neutral ones.
const std::map<std::string, hidden::EffectParameters>& NeutralEffects();

/// What is not named is neutral. Beside the catalogue's parameters em_distortion may have
/// `offset_at_centre_m`. The mass per length is all of it: what is beyond `nominal` acts as effect.
/// Throws InputError, without a file's name, for an unknown effect or parameter or a wrong count.
InstrumentEffects EffectsByName(const std::map<std::string, hidden::EffectParameters>& values,
                                const Instrument& nominal);

}  // namespace flextip::simulation
