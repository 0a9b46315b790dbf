#include "bench/matrix_truth.h"

#include <cmath>

namespace flextip {

EffectParameters TruthOf(const HiddenRecording& hidden, const std::string& effect) {
  EffectParameters truth = hidden.label.parameters.at(effect);
  if (effect == "self_weight") {  // drawn beyond the nominal one
    truth["mass_per_length_kg_m"][0] += hidden.recording.instrument.mass_per_length_kg_m;
  }
  // A pose found from tags keeps its attitude to the line of sight, which the scale moves.
  if (effect == "focal_length") truth["turn"] = {std::log(truth.at("scale").at(0))};
  return truth;
}

}  // namespace flextip
