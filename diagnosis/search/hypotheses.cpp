#include "diagnosis/search/hypotheses.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace flextip::diagnosis {

double LogPrior(const Hypothesis& h, int effects, const SelectionOptions& options) {
  const double n = std::max(1, effects);
  if (h.unknown) return std::log(options.prior_unknown / (n + 1.0));
  if (h.effects.empty()) return std::log(options.prior_none);
  if (h.effects.size() == 1) return std::log(options.prior_singles / n);
  return std::log(options.prior_pairs / (n * std::max(1.0, n - 1.0) / 2.0));
}

std::vector<Hypothesis> KnownHypotheses(int effects, bool pairs) {
  std::vector<Hypothesis> known = {{{}, false}};
  for (int i = 0; i < effects; ++i) {
    known.push_back({{i}, false});
    for (int j = i + 1; pairs && j < effects; ++j) known.push_back({{i, j}, false});
  }
  return known;
}

std::vector<Hypothesis> AllHypotheses(int effects) {
  std::vector<Hypothesis> all = KnownHypotheses(effects, true);
  all.push_back({{}, true});
  for (int i = 0; i < effects; ++i) all.push_back({{i}, true});
  return all;
}

std::vector<ScoredHypothesis> Score(const Evidence& evidence, int effects,
                                    const std::vector<Hypothesis>& hypotheses,
                                    const SelectionOptions& options,
                                    const std::vector<Correction>& corrections) {
  std::vector<ScoredHypothesis> scored(hypotheses.size());
  tbb::parallel_for(std::size_t{0}, hypotheses.size(), [&](std::size_t i) {
    scored[i].weighed = evidence.Weigh(hypotheses[i]);
    scored[i].log_posterior =
        scored[i].weighed.log_evidence + LogPrior(hypotheses[i], effects, options);
    for (const Correction& correction : corrections)
      if (correction.hypothesis == hypotheses[i]) scored[i].log_posterior += correction.log;
  });
  std::stable_sort(scored.begin(), scored.end(),
                   [](const auto& a, const auto& b) { return a.log_posterior > b.log_posterior; });
  return scored;
}

}  // namespace flextip::diagnosis
