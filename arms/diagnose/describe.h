// What the answer means in numbers and words: parameters, what cannot be told, errors, curves.
#pragma once

#include <vector>

#include "arms/diagnose/diagnose.h"
#include "arms/diagnose/heldout.h"
#include "arms/search/search.h"

namespace flextip::arms {

/// Names of a hypothesis' effects, sorted: with `only` -1 those that all recordings share, else all
/// that recording has. None and unknown by those names.
diagnosis::Verdict VerdictIn(const diagnosis::Hypothesis& hypothesis, const Layout& layout,
                             int only);

/// Fills all of `result` but the probabilities, which its answer holds already. `p`: of each scored
/// hypothesis.
void Describe(const Replay& base, const Replay& extended, const Found& found,
              const ArmHeldOut& heldout, const std::vector<double>& p, ArmResult& result);

/// Fills the answer of recording `r`.
void DescribeRecording(const Replay& extended, const Found& found, const ArmHeldOut& heldout, int r,
                       const ArmResult& result, diagnosis::DiagnosisResult& answer);

}  // namespace flextip::arms
