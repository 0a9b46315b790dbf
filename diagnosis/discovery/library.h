// The forms that a term may have: shapes of variables over a grid of their parameters.
#pragma once

#include <vector>

#include "diagnosis/effects/discovered/term_columns.h"

namespace flextip::diagnosis {

/// Returns the targets of which the recording says something.
std::vector<TermTarget> TargetsOf(const SampleSet& set);

/// Returns the candidates for `target`, `states` being what its variables were. All with a constant
/// beside them; the first is the constant alone. None of a friction where nothing presses.
std::vector<Term> Library(TermTarget target, const std::vector<TermState>& states,
                          const SampleSet& set);

/// Returns how far apart two values of the shape's parameter number `i` of a grid are: where a
/// refinement begins. Of scales, as a part of the value.
double StepOf(const Term& term, std::size_t i, const std::vector<TermState>& states);
/// Whether the parameter is a scale, refined as its logarithm.
bool IsScale(const Term& term, std::size_t i);

}  // namespace flextip::diagnosis
