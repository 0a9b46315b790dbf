#include "arms/search/score.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace flextip::arms {
namespace {

using diagnosis::Evidence;
using diagnosis::Hypothesis;

/// Whether two of its effects are the same in one recording.
bool Repeats(const Hypothesis& hypothesis, const Layout& layout) {
  for (std::size_t i = 0; i < hypothesis.effects.size(); ++i)
    for (std::size_t j = i + 1; j < hypothesis.effects.size(); ++j) {
      const auto& a = layout.Blocks()[hypothesis.effects[i]];
      const auto& b = layout.Blocks()[hypothesis.effects[j]];
      if (a.effect->Name() != b.effect->Name()) continue;
      if (!a.change && !b.change) return true;
      if (a.change && b.change && a.effect->ComesAndGoes() && a.in == b.in) return true;
    }
  return false;
}

}  // namespace

double LogPriorOf(const Hypothesis& hypothesis, int effects, const SearchOptions& options) {
  const double n = std::max(1, effects);
  if (hypothesis.unknown) return std::log(options.prior_unknown);
  const std::size_t size = hypothesis.effects.size();
  if (size == 0) return std::log(options.prior_none);
  double log_count = 0.0;  // of choices of so many
  for (std::size_t i = 0; i < size; ++i)
    log_count += std::log(std::max(1.0, n - double(i)) / double(i + 1));
  if (size == 1) return std::log(options.prior_single) - log_count;
  return std::log(options.prior_pair) + double(size - 2) * std::log(options.prior_more) - log_count;
}

std::vector<Scored> ScoreHypotheses(const Evidence& evidence, const Layout& layout,
                                    const SearchOptions& options, const std::set<int>& forbidden,
                                    bool unknown) {
  std::vector<Scored> all;
  std::set<std::vector<int>> seen;
  const auto weigh = [&](const std::vector<Hypothesis>& hypotheses) {
    std::vector<Scored> scored(hypotheses.size());
    tbb::parallel_for(std::size_t{0}, hypotheses.size(), [&](std::size_t i) {
      scored[i].weighed = evidence.Weigh(hypotheses[i]);
      scored[i].log_posterior =
          scored[i].weighed.log_evidence + LogPriorOf(hypotheses[i], layout.EffectCount(), options);
    });
    std::stable_sort(scored.begin(), scored.end(), IsBetter);
    all.insert(all.end(), scored.begin(), scored.end());
    return scored;
  };
  std::vector<Hypothesis> frontier{{}};
  if (unknown) weigh({Hypothesis{{}, true}});
  weigh(frontier);
  double best = all.front().log_posterior;
  for (int size = 1; size <= options.most_effects; ++size) {
    std::vector<Hypothesis> next;
    for (const Hypothesis& h : frontier)
      for (int b = 0; b < layout.EffectCount(); ++b) {
        if (forbidden.contains(b)) continue;
        if (std::find(h.effects.begin(), h.effects.end(), b) != h.effects.end()) continue;
        Hypothesis longer = h;
        longer.effects.push_back(b);
        std::sort(longer.effects.begin(), longer.effects.end());
        if (Repeats(longer, layout) || !seen.insert(longer.effects).second) continue;
        next.push_back(longer);
      }
    if (next.empty()) break;
    const auto scored = weigh(next);
    frontier.clear();
    // Pairs may show what neither shows alone: all singles are extended.
    const std::size_t keep = size == 1 ? scored.size() : std::size_t(options.beam);
    for (std::size_t i = 0; i < scored.size() && i < keep; ++i)
      frontier.push_back(scored[i].weighed.hypothesis);
    if (size > 2 && scored.front().log_posterior < best - 12.0) break;
    best = std::max(best, scored.front().log_posterior);
  }
  std::stable_sort(all.begin(), all.end(), IsBetter);
  return all;
}

}  // namespace flextip::arms
