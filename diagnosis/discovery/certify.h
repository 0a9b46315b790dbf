// Whether a term is there: found on one half of the blocks of time, judged on the other.
#pragma once

#include <vector>

#include "diagnosis/discovery/candidates.h"

namespace flextip::diagnosis {

/// The probability that blocks without the term would favour it as much as those of `unseen` do,
/// `term` having been chosen and fitted on `seen` alone (weights by block). Student's t of the
/// blocks' own gains: the scatter from block to block counts, so slow noise does not pass for a
/// term.
double FalseDiscovery(const ResidualProblem& problem, const Term& term,
                      const std::vector<double>& seen, const std::vector<double>& unseen);

/// How many samples count as one in what is left once the model has the term too, in the rows that
/// the term moves: slow noise looks like a term, and leaves as slow a rest.
double SamplesAsOne(const ResidualProblem& problem, const Term& term, const StatesByTarget& states);

/// The part of `bags` resamplings of the blocks in which the first of `leaders` (or one of its
/// target, shape and variable) stays the best of them.
double Stability(const ResidualProblem& problem, const std::vector<Candidate>& leaders,
                 const StatesByTarget& states, int bags);

/// Upper tail of Student's t with `freedom` degrees (Wallace 1959, to a few percent).
double StudentTail(double t, double freedom);

}  // namespace flextip::diagnosis
