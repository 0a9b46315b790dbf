// The label's numbers in the terms the diagnosis reports in.
#pragma once

#include <string>

#include "simulation/hidden_recording.h"

namespace flextip {

/// Of one effect of the catalogue, present or not. The mass per length is all of it.
EffectParameters TruthOf(const HiddenRecording& hidden, const std::string& effect);

}  // namespace flextip
