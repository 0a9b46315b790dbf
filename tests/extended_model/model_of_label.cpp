#include "tests/extended_model/model_of_label.h"

#include <cmath>

#include "diagnosis/model/catalogue.h"
#include "diagnosis/model/extended_effect.h"
#include "simulation/sensors/sensors.h"

namespace flextip {

diagnosis::ExtendedModel ModelOfLabel(const hidden::HiddenRecording& hidden) {
  diagnosis::ExtendedModel model;
  model.start_ns = simulation::kSimulationStart_ns;
  int count = 0;
  if (hidden.recording.em0) {  // measured with less bias than matters
    for (const auto& sample : hidden.recording.em0->samples) {
      model.centre_m += sample.value.p_RS;
      ++count;
    }
    model.centre_m /= count;
  }
  for (const std::string& name : hidden.label.present) {
    diagnosis::EffectFit fit{name, diagnosis::ParametersOf(*diagnosis::MakeEffect(name))};
    const simulation::EffectParameters& label = hidden.label.parameters.at(name);
    for (diagnosis::ReportedParameter& parameter : fit.parameters) {
      // A pose found from tags keeps its attitude to the line of sight, which scale or lens moves.
      if (name == "focal_length" && parameter.name == "turn")
        parameter.value[0] = std::log(label.at("scale").at(0));
      if (name == "lens_radial" && parameter.name != "k1")
        parameter.value[0] = (parameter.name == "depth" ? 2.0 : 1.0) * label.at("k1").at(0);
      if (!label.contains(parameter.name)) continue;  // none in the simulation
      parameter.value = label.at(parameter.name);
      // The label's mass is beyond the nominal one.
      if (name == "self_weight") parameter.value[0] += hidden.scene.instrument.mass_per_length_kg_m;
    }
    model.effects.push_back(fit);
  }
  return model;
}

}  // namespace flextip
