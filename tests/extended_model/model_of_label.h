// The extended model that a perfect diagnosis would have found.
#pragma once

#include "diagnosis/extended_model.h"
#include "simulation/hidden_recording.h"

namespace flextip {

/// Of the effects present in `hidden`, with the label's parameters.
ExtendedModel ModelOfLabel(const HiddenRecording& hidden);

}  // namespace flextip
