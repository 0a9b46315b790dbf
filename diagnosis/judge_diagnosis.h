// Judges whether the answer of a diagnosis holds.
#pragma once

#include "core/judgement.h"
#include "diagnosis/diagnose.h"

namespace flextip::diagnosis {

/// Returns the answer in a sentence, graded: not found where even the extended model leaves a
/// misfit that no effect has but a wrong unit, clock or frame; to be used with care where there are
/// warnings or the search did not come to rest. The next step tells a group's members apart.
Judgement JudgeDiagnosis(const DiagnosisResult& result);

}  // namespace flextip::diagnosis
