// Found parameters beside the label's.
#pragma once

#include <vector>

#include "bench/matrix_record.h"
#include "diagnosis/diagnose.h"

namespace flextip {

/// Every number of the effects that are present, were found and are named by the label. Phases are
/// compared modulo a turn, a breath in the sign that was found.
std::vector<JudgedParameter> JudgeParameters(const HiddenRecording& hidden,
                                             const DiagnosisResult& result);

/// The numbers' bounds, where `bounds` (matrix_bound.h) has them.
void SetBounds(const std::vector<EffectFit>& bounds, std::vector<JudgedParameter>& parameters);

}  // namespace flextip
