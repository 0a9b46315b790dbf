// A selection in the words of a result.
#pragma once

#include <optional>
#include <string>

#include "diagnosis/diagnose.h"
#include "diagnosis/search/selection.h"

namespace flextip::diagnosis {

/// Returns what to say of residuals that remember themselves.
std::string MemoryWarning(const ResidualMemory& memory);

/// Sets the parameters of `weighed`, with the others within tolerance: what the extended model is
/// made of. `extended` stands at the best point of `selection`; the first `effects` of its layout,
/// or all, are the catalogue's.
void DescribeParameters(const Replay& extended, const Selection& selection,
                        const WeighedHypothesis& weighed, DiagnosisResult& result,
                        std::optional<int> effects = {});

/// Sets what cannot be told apart and, with `find_motion`, the motion that would tell it.
void DescribeAmbiguity(const Replay& extended, const Selection& selection,
                       const WeighedHypothesis& weighed, bool find_motion, DiagnosisResult& result);

/// Sets counts, noise, catalogue, nominal values, and adds the samples' warnings.
void DescribeRecording(const Replay& extended, const Selection& selection, TimeNs start_ns,
                       DiagnosisResult& result);

}  // namespace flextip::diagnosis
