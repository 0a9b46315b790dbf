#include "diagnosis/search/tried_fits.h"

#include <algorithm>

namespace flextip::diagnosis {

std::vector<Hypothesis> PartsOf(const Hypothesis& whole) {
  std::vector<Hypothesis> parts;
  for (const int effect : whole.effects) {
    parts.push_back(whole);
    std::erase(parts.back().effects, effect);
  }
  return parts;
}

void TriedFits::Keep(const HypothesisFit& fit) {
  ++count_;
  const auto before = std::ranges::find(fits_, fit.hypothesis, &HypothesisFit::hypothesis);
  if (before == fits_.end()) {
    fits_.push_back(fit);
  } else if (fit.log_posterior > before->log_posterior) {
    *before = fit;
  }
  if (fit.log_posterior > best_.log_posterior) best_ = fit;
}

void TriedFits::Clear() {
  fits_.clear();
  best_ = {};
}

const HypothesisFit* TriedFits::Find(const Hypothesis& hypothesis) const {
  const auto found = std::ranges::find(fits_, hypothesis, &HypothesisFit::hypothesis);
  return found == fits_.end() ? nullptr : &*found;
}

std::vector<HypothesisFit> TriedFits::Near(double log_odds) const {
  std::vector<HypothesisFit> near;
  for (const HypothesisFit& fit : fits_)
    if (fit.log_posterior >= best_.log_posterior - log_odds) near.push_back(fit);
  std::ranges::stable_sort(near, std::ranges::greater(), &HypothesisFit::log_posterior);
  return near;
}

std::vector<Hypothesis> TriedFits::WithLarger(std::vector<Hypothesis> hypotheses) const {
  for (const HypothesisFit& fit : fits_)
    if (fit.hypothesis.effects.size() > 2 &&
        std::ranges::find(hypotheses, fit.hypothesis) == hypotheses.end())
      hypotheses.push_back(fit.hypothesis);
  return hypotheses;
}

double TriedFits::Shortfall(const ScoredHypothesis& s, const Weighing& weighing) const {
  const Hypothesis& h = s.weighed.hypothesis;
  if (const HypothesisFit* own = Find(h))
    return own->log_posterior - s.log_posterior - weighing.log_none;
  double worst = 0.0;
  for (const HypothesisFit& part : fits_) {
    const auto& effects = part.hypothesis.effects;
    if (effects.empty() || effects.size() >= h.effects.size()) continue;
    if (part.hypothesis == best_.hypothesis || !std::ranges::includes(h.effects, effects)) continue;
    for (const auto& weighed : weighing.scored)
      if (weighed.weighed.hypothesis == part.hypothesis)
        worst = std::min(worst, part.log_posterior - weighed.log_posterior - weighing.log_none);
  }
  return worst;
}

}  // namespace flextip::diagnosis
