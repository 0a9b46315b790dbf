// The extended model that a perfect diagnosis would have found.
#pragma once

#include "diagnosis/model/extended_model.h"
#include "testdata/hidden/recording.h"

namespace flextip {

/// Of the effects present in `hidden`, with the label's parameters.
diagnosis::ExtendedModel ModelOfLabel(const hidden::HiddenRecording& hidden);

}  // namespace flextip
