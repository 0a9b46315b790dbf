// The forms that explain a residual best, one of each kind, refined.
#pragma once

#include <map>
#include <vector>

#include "diagnosis/discovery/target_scan.h"

namespace flextip::diagnosis {

struct Candidate {
  Term term;
  double gain = 0.0;       ///< what it takes off the cost, the offset's part included
  double criterion = 0.0;  ///< twice the log of its odds against no term: gain less complexity
  std::vector<double> at_sd = {};  ///< of the shape's parameters
};

using StatesByTarget = std::map<TermTarget, std::vector<TermState>>;

/// Returns one candidate of each target, shape and variable that may matter, best first. A gain
/// counts in the variance that the best candidate leaves, at least the noise's; each number found
/// costs the logarithm of the samples. What would have to be absurdly large is left out: where a
/// target hardly moves anything, its linear share means nothing.
/// `fast_waves_only`: periodic ones alone, and only those as fast as noise.
std::vector<Candidate> FindCandidates(const WeightedProblem& weighted, const StatesByTarget& states,
                                      bool fast_waves_only = false);

/// Returns half of the range of the term's part that varies, but for the hundredth of the samples
/// at either end, in the target's tolerances; of a constant, its size.
double HalfRange(const Term& term, const std::vector<TermState>& states);

/// The variance (of whitened rows) that the best leaves, at least one.
double VarianceLeft(const WeightedProblem& weighted, double gain);
/// Twice the log odds.
double Criterion(const Candidate& candidate, double variance, double samples);

}  // namespace flextip::diagnosis
