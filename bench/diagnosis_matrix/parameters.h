// Found parameters beside the label's.
#pragma once

#include <vector>

#include "bench/diagnosis_matrix/record.h"
#include "diagnosis/diagnose.h"

namespace flextip::bench {

/// Every number of the effects that are present, were found and are named by the label. Phases are
/// compared modulo a turn, a breath in the sign that was found.
std::vector<JudgedParameter> JudgeParameters(const hidden::HiddenRecording& hidden,
                                             const diagnosis::DiagnosisResult& result);

/// The numbers' bounds, where `bounds` (bound.h) has them.
void SetBounds(const std::vector<diagnosis::EffectFit>& bounds,
               std::vector<JudgedParameter>& parameters);

}  // namespace flextip::bench
