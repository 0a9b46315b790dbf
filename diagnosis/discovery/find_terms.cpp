#include "diagnosis/discovery/find_terms.h"

#include <algorithm>
#include <array>

#include "diagnosis/samples/noise_level.h"

namespace flextip::diagnosis {
namespace {

constexpr double kNoisier = 1.15;  // times the data sheets' noise: something fast may be in it
constexpr double kBetter = 20.0;   // twice the log odds by which terms alone must beat the effects
constexpr double kMostOf = 0.7;    // of what several effects explain: terms that are worth a fit
/// The same, fitted in full, where several effects take the part: each of the many combinations of
/// effects is less likely beforehand than terms.
constexpr double kBetterThanSeveral = 0.0;
/// Where nothing is named no effect's form can be a little off: a weaker term counts.
constexpr double kLeastBesideNone = 0.01;

/// Whether a term is what one of `effects` says already: friction by a hysteresis of the depth is
/// that of a bristle (Dahl), which sticks.
bool IsSaidBy(const ParameterLayout& layout, const std::vector<int>& effects,
              const TermSearch& search) {
  return std::ranges::any_of(search.terms, [&](const FoundTerm& found) {
    const bool is_hysteresis =
        found.term.shape == TermShape::kPlay || found.term.shape == TermShape::kSmoothPlay;
    const int input = InfoOf(found.term.target).first_input;
    return is_hysteresis && found.term.variable == TermVariable::kInsertionDepth &&
           std::ranges::any_of(effects, [&](int b) {
             return layout.Blocks()[b].effect->HysteresisInput() == input;
           });
  });
}

/// Swings that are fast enough pass for noise: looked for in the stated noise.
std::vector<FoundTerm> FindFast(Replay& best, const Eigen::VectorXd& prior_sd) {
  const auto measured = best.NoiseScales();
  if (*std::max_element(measured.begin(), measured.end()) < kNoisier) return {};
  std::array<double, kChannelCount> stated;
  stated.fill(1.0);
  best.SetNoiseScale(stated);
  const TermSearch search =
      SearchTerms(best, prior_sd, {}, {.most_terms = 2, .fast_waves_only = true});
  best.SetNoiseScale(measured);
  return search.terms;
}

std::vector<FoundTerm> Joined(std::vector<FoundTerm> terms, const std::vector<FoundTerm>& more) {
  terms.insert(terms.end(), more.begin(), more.end());
  return terms;
}

/// What a model leaves where it stands, no further term looked for.
TermSearch Standing(const Replay& replay, const Eigen::VectorXd& prior_sd) {
  return SearchTerms(replay, prior_sd, {}, {.most_terms = 0});
}

double CostHere(const Replay& replay, const Eigen::VectorXd& prior_sd) {
  return Standing(replay, prior_sd).cost;
}

/// A fit of terms in the noise of `best`: from the base, terms of something large are only nearly
/// right, as effects are.
TermSearch AtFit(TermModel& fit, const Replay& best) {
  fit.extended.Use(best.SettingsNow());
  return Standing(fit.extended,
                  fit.layout.Widened(fit.weighed.hypothesis.effects, fit.weighed.scales));
}

}  // namespace

std::unique_ptr<TermModel> FindTerms(const Replay& base, Replay& best, const Selection& selection,
                                     const WeighedHypothesis& known,
                                     const DiagnoseOptions& options) {
  const ParameterLayout& layout = best.Layout();
  const auto sd = [&](const WeighedHypothesis& weighed) {
    return layout.Widened(weighed.hypothesis.effects, weighed.scales);
  };
  std::vector<FoundTerm> fast = FindFast(best, sd(known));
  Replay bare_base = base;
  bare_base.Evaluate(base.Theta());  // with the frequencies that were found since
  if (!fast.empty()) {
    const auto model = FitTerms(base, best, selection, known.hypothesis.effects, fast, options);
    if (model) {
      best.SetNoiseScale(model->extended.NoiseScales());
      bare_base.SetNoiseScale(model->extended.NoiseScales());
    } else {
      fast.clear();
    }
  }
  std::vector<int> effects = known.hypothesis.effects;
  DiscoverOptions beside;
  if (effects.empty()) beside.least_left = kLeastBesideNone;
  TermSearch search = SearchTerms(best, sd(known), fast, beside);
  const Replay* from = &best;
  if (!effects.empty()) {
    const Eigen::VectorXd none = sd({});
    const auto is_better = [&](const TermSearch& bare) {
      return !bare.terms.empty() && LogOdds(bare, search) > kBetter;
    };
    const auto fits_better = [&](const TermSearch& bare) {
      if (effects.size() < 2 || bare.terms.empty()) return false;
      const double nothing = CostHere(bare_base, none);
      if (nothing - bare.cost < kMostOf * (nothing - search.cost)) return false;
      const auto fit = FitTerms(base, bare_base, selection, {}, Joined(fast, bare.terms), options);
      return fit && LogOdds(AtFit(*fit, best), search) > kBetterThanSeveral;
    };
    // Terms that need not hold explain more than those that do, and are found in a third of the
    // time: mostly they say already that the effects are better.
    const TermSearch perhaps = SearchTerms(bare_base, none, fast, {.certify = false});
    if (is_better(perhaps) || fits_better(perhaps)) {
      const TermSearch bare = SearchTerms(bare_base, none, fast);
      if ((is_better(bare) || fits_better(bare)) && !IsSaidBy(layout, effects, bare)) {
        search = bare;
        effects.clear();
        from = &bare_base;
      }
    }
  }
  const std::vector<FoundTerm> found = Joined(fast, search.terms);
  if (found.empty()) return {};
  return FitTerms(base, *from, selection, effects, found, options);
}

}  // namespace flextip::diagnosis
