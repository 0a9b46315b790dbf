#include "diagnosis/effects/registration.h"

namespace flextip::diagnosis {

bool Registration::Applies(const SampleSet& samples) const {
  const SensorNoises& n = samples.noise;
  return n.em_registration_rad > 0 || n.em_registration_m > 0 || n.vision_registration_rad > 0 ||
         n.vision_registration_m > 0;
}

std::vector<FitParameter> Registration::Parameters(const SampleSet& samples) const {
  const SensorNoises& n = samples.noise;
  std::vector<FitParameter> all;
  for (const double sd : {n.em_registration_rad, n.em_registration_m, n.vision_registration_rad,
                          n.vision_registration_m}) {
    for (int i = 0; i < 3; ++i) all.push_back({sd, sd, false});
  }
  return all;
}

void Registration::Apply(const double*, const Instant&, EffectMemory&, InputChange& change) const {
  for (int i = 0; i < 12; ++i) change.Linear(i, sample_input::kEmTurn + i, 1.0);
}

std::vector<DirectEffect::Named> Registration::Names() const {
  return {{"em_rotation_rad", 3},
          {"em_translation_m", 3},
          {"vision_rotation_rad", 3},
          {"vision_translation_m", 3}};
}

}  // namespace flextip::diagnosis
