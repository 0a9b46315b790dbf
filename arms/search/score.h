// Hypotheses weighed about one place.
#pragma once

#include <set>
#include <vector>

#include "arms/replay/layout.h"
#include "diagnosis/evidence/evidence.h"

namespace flextip::arms {

struct SearchOptions {
  int parts = 20;             ///< of a recording, for bagging and held-out stretches
  double discrepancy = 0.02;  ///< what a right form may miss of what is to be explained, relative
  int most_effects = 6;       ///< together
  int beam = 8;               ///< hypotheses of each size that are extended
  double prior_none = 0.5, prior_single = 0.33, prior_pair = 0.08, prior_more = 0.25;
  double prior_unknown = 0.05;
};

struct Scored {
  diagnosis::WeighedHypothesis weighed;
  double log_posterior = 0.0;  ///< not normalised
  double correction = 0.0;     ///< of it: what its own fit says beyond the linear problem
};

/// Whether `a` comes before `b`, best first.
inline bool IsBetter(const Scored& a, const Scored& b) { return a.log_posterior > b.log_posterior; }

double LogPriorOf(const diagnosis::Hypothesis& hypothesis, int effects,
                  const SearchOptions& options);

/// Returns none, all singles and pairs and the likeliest longer hypotheses, best first: without the
/// effects of `forbidden`, with the unknown where asked for.
std::vector<Scored> ScoreHypotheses(const diagnosis::Evidence& evidence, const Layout& layout,
                                    const SearchOptions& options, const std::set<int>& forbidden,
                                    bool unknown);

}  // namespace flextip::arms
