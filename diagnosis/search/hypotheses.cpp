#include "diagnosis/search/hypotheses.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace flextip::diagnosis {

namespace {

constexpr std::size_t kMostEffects = 4;
constexpr std::size_t kGrown = 5;  // leaders of so many effects that get one more

double LogChoose(double n, double k) {
  return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0);
}

void SortBestFirst(std::vector<ScoredHypothesis>& scored) {
  std::ranges::stable_sort(
      scored, [](const auto& a, const auto& b) { return a.log_posterior > b.log_posterior; });
}

/// Those of `scored`, which is best first, that have `size` effects and nothing unknown.
std::vector<const ScoredHypothesis*> OfSize(const std::vector<ScoredHypothesis>& scored,
                                            std::size_t size) {
  std::vector<const ScoredHypothesis*> found;
  for (const auto& s : scored) {
    const Hypothesis& h = s.weighed.hypothesis;
    if (!h.unknown && h.effects.size() == size) found.push_back(&s);
  }
  return found;
}

/// The first kGrown of `leaders`, each with each further effect, as far as not among `before`.
std::vector<Hypothesis> WithOneMore(const std::vector<const ScoredHypothesis*>& leaders,
                                    const std::vector<const ScoredHypothesis*>& before,
                                    int effects) {
  std::set<std::vector<int>> seen;
  for (const ScoredHypothesis* s : before) seen.insert(s->weighed.hypothesis.effects);
  std::vector<Hypothesis> grown;
  for (std::size_t i = 0; i < std::min(kGrown, leaders.size()); ++i) {
    for (int e = 0; e < effects; ++e) {
      std::vector<int> more = leaders[i]->weighed.hypothesis.effects;
      if (std::ranges::find(more, e) != more.end()) continue;
      more.insert(std::ranges::upper_bound(more, e), e);
      if (seen.insert(more).second) grown.push_back({more, false});
    }
  }
  return grown;
}

}  // namespace

double LogPrior(const Hypothesis& h, int effects, const SelectionOptions& options) {
  const double n = std::max(1, effects), k = double(h.effects.size());
  if (h.unknown) return std::log(options.prior_unknown / (n + 1.0));
  if (h.effects.empty()) return std::log(options.prior_none);
  const double together = k == 1.0   ? options.prior_singles
                          : k == 2.0 ? options.prior_pairs
                                     : options.prior_triples * std::pow(0.25, k - 3.0);
  return std::log(together) - LogChoose(std::max(n, k), k);
}

std::vector<Hypothesis> KnownHypotheses(int effects, std::size_t most) {
  std::vector<Hypothesis> known = {{{}, false}};
  for (std::size_t i = 0; i < known.size(); ++i) {
    const std::vector<int> fewer = known[i].effects;
    if (fewer.size() == most) break;
    for (int e = fewer.empty() ? 0 : fewer.back() + 1; e < effects; ++e) {
      std::vector<int> more = fewer;
      more.push_back(e);
      known.push_back({more, false});
    }
  }
  return known;
}

std::vector<Hypothesis> AllHypotheses(int effects) {
  std::vector<Hypothesis> all = KnownHypotheses(effects, 2);
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
  SortBestFirst(scored);
  return scored;
}

std::vector<ScoredHypothesis> Grown(const Evidence& evidence, int effects,
                                    std::vector<ScoredHypothesis> scored,
                                    const SelectionOptions& options,
                                    const std::vector<Correction>& corrections) {
  for (std::size_t size = 2; size < kMostEffects; ++size) {
    const auto fewer = OfSize(scored, size - 1), leaders = OfSize(scored, size);
    if (leaders.empty() || fewer.empty()) break;
    if (leaders.front()->log_posterior < fewer.front()->log_posterior) break;
    const auto more =
        Score(evidence, effects, WithOneMore(leaders, OfSize(scored, size + 1), effects), options,
              corrections);
    scored.insert(scored.end(), more.begin(), more.end());
    SortBestFirst(scored);
  }
  return scored;
}

}  // namespace flextip::diagnosis
