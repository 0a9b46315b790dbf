// The hypotheses that were fitted by themselves, and what their fits say of the others.
#pragma once

#include <vector>

#include "diagnosis/search/hypothesis_fit.h"

namespace flextip::diagnosis {

class TriedFits {
 public:
  /// Of several fits of one hypothesis the best counts.
  void Keep(const HypothesisFit& fit);
  /// Forgets all fits, as after a change of noise; the count of fits goes on.
  void Clear();

  /// Null where `hypothesis` was not fitted.
  const HypothesisFit* Find(const Hypothesis& hypothesis) const;
  /// The likeliest; its log posterior is -1e300 as long as there is none.
  const HypothesisFit& Best() const { return best_; }
  int Count() const { return count_; }
  /// Returns those within `log_odds` of the best, the best first.
  std::vector<HypothesisFit> Near(double log_odds) const;

  /// `hypotheses`, and those of more effects than two that were fitted.
  std::vector<Hypothesis> WithLarger(std::vector<Hypothesis> hypotheses) const;

  /// What the fits say of `s` beyond the linear problem about the best place (log odds): its own
  /// fit, or the worst of those of its parts, whose broken promise is its
  /// promise too.
  double Shortfall(const ScoredHypothesis& s, const Weighing& weighing) const;

 private:
  std::vector<HypothesisFit> fits_;
  HypothesisFit best_;
  int count_ = 0;
};

/// Each of `whole`'s effects left out in turn.
std::vector<Hypothesis> PartsOf(const Hypothesis& whole);

}  // namespace flextip::diagnosis
