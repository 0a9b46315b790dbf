#include "diagnosis/discovery/find_terms.h"

#include <algorithm>
#include <array>
#include <optional>

#include "diagnosis/heldout.h"
#include "diagnosis/samples/noise_level.h"

namespace flextip::diagnosis {
namespace {

constexpr double kNoisier = 1.15;  // times the data sheets' noise: something fast may be in it
constexpr double kBetter = 20.0;   // twice the log odds by which terms alone must beat the effects
constexpr double kWorse = 1.5;     // times what was left: the noise is taken anew with the terms
constexpr double kMostOf = 0.7;    // of what several effects explain: terms that are worth a fit
/// The same, fitted in full, where several effects take the part: each of the many combinations of
/// effects is less likely beforehand than terms.
constexpr double kBetterThanSeveral = 0.0;

/// Where nothing is named no effect's form can be a little off: a weaker and a smaller term counts.
DiscoverOptions BesideNone() {
  return {.least_first = {.part = 0.004, .left = 0.004, .tolerances = 1.5}};
}

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

/// Terms beside the catalogue's answer, or in its place.
class TermChoice {
 public:
  /// Measures the noise anew where something fast passed for noise.
  TermChoice(const Replay& base, Replay& best, const Selection& selection,
             const WeighedHypothesis& known, const DiagnoseOptions& options)
      : base_(base),
        bare_(base),
        best_(best),
        selection_(selection),
        known_(known),
        options_(options) {
    bare_.Evaluate(base.Theta());  // with the frequencies that were found since
    fast_ = FindFast(best, KnownSd());
    if (fast_.empty()) return;
    const auto model = FitTerms(base, best, selection, Effects(), fast_, options);
    if (!model) {
      fast_.clear();
      return;
    }
    best_.SetNoiseScale(model->extended.NoiseScales());
    bare_.SetNoiseScale(model->extended.NoiseScales());
  }

  /// Where terms far from small were right only as long as they are small, they leave, fitted, more
  /// than before: then the first of them alone, or nothing.
  std::unique_ptr<TermModel> Make() {
    Choice choice = Choose();
    auto model = Fit(choice, kWorse);
    if (!model && choice.terms.size() > fast_.size() + 1) {
      choice.terms.resize(fast_.size() + 1);
      model = Fit(choice, 1.0);
    }
    if (!model) return {};
    auto more = WithFurther(*model);
    return more && !LeavesMore(*more, model->extended) ? std::move(more) : std::move(model);
  }

 private:
  struct Choice {
    const Replay* from;
    std::vector<int> effects;
    std::vector<FoundTerm> terms;
  };

  Choice Choose() {
    DiscoverOptions options;
    if (Effects().empty()) options = BesideNone();
    beside_ = SearchTerms(best_, KnownSd(), fast_, options);
    if (const auto alone = InPlaceOfEffects()) return {&bare_, {}, Joined(fast_, alone->terms)};
    return {&best_, Effects(), Joined(fast_, beside_.terms)};
  }

  /// Null where the fit leaves more than `worse` times what was left.
  std::unique_ptr<TermModel> Fit(const Choice& choice, double worse) const {
    if (choice.terms.empty()) return {};
    auto model = FitTerms(base_, *choice.from, selection_, choice.effects, choice.terms, options_);
    return model && !LeavesMore(*model, best_, worse) ? std::move(model) : nullptr;
  }

  static bool LeavesMore(const TermModel& model, const Replay& before, double worse = kWorse) {
    return model.extended.ChiSquaredPerDof() > worse * before.ChiSquaredPerDof();
  }

  static double HeldOutError(const TermModel& model) {
    return MeasureHeldOut(model.base, model.extended, model.selection, model.weighed)
        .gain.heldout_error_ratio;
  }

  /// With the terms that show once those of `model` are fitted: a form that is only near hid the
  /// rest of a law, a wave its overtone. Null where there are none, and where they do not tell of
  /// stretches that they were not fitted to.
  std::unique_ptr<TermModel> WithFurther(const TermModel& model) const {
    DiscoverOptions options;
    options.most_terms -= int(model.found.size());
    if (options.most_terms <= 0) return {};
    for (const FoundTerm& one : model.found) options.completed.push_back(one.term);
    const WeighedHypothesis& known = model.weighed;
    const Eigen::VectorXd sd = model.layout.Widened(known.hypothesis.effects, known.scales);
    const TermSearch further = SearchTerms(model.extended, sd, {}, options);
    if (further.terms.empty()) return {};
    std::vector<int> effects = known.hypothesis.effects;
    std::erase_if(effects, [&](int b) { return b >= model.first_term; });
    auto more = FitTerms(base_, model.extended, selection_, effects,
                         Joined(model.Fitted(), further.terms), options_);
    return more && HeldOutError(*more) < HeldOutError(model) ? std::move(more) : nullptr;
  }

  const std::vector<int>& Effects() const { return known_.hypothesis.effects; }
  Eigen::VectorXd KnownSd() const { return best_.Layout().Widened(Effects(), known_.scales); }
  Eigen::VectorXd NoneSd() const { return best_.Layout().Widened({}, {}); }

  std::optional<TermSearch> InPlaceOfEffects() {
    if (Effects().empty()) return {};
    // Terms that need not hold explain more than those that do, and are found in a third of the
    // time: mostly they say already that the effects are better.
    DiscoverOptions options = BesideNone();
    options.certify = false;
    if (!IsBetter(SearchTerms(bare_, NoneSd(), fast_, options))) return {};
    options.certify = true;
    TermSearch alone = SearchTerms(bare_, NoneSd(), fast_, options);
    if (!IsBetter(alone) || IsSaidBy(best_.Layout(), Effects(), alone)) return {};
    return alone;
  }

  bool IsBetter(const TermSearch& alone) {
    if (alone.terms.empty()) return false;
    return LogOdds(alone, beside_) > kBetter || (Effects().size() > 1 && IsBetterFitted(alone));
  }

  /// From the base, terms of something large are only nearly right, as effects are: fitted in full,
  /// as the effects were, where they explain about as much.
  bool IsBetterFitted(const TermSearch& alone) {
    const double nothing = Standing(bare_, NoneSd()).cost;
    if (nothing - alone.cost < kMostOf * (nothing - beside_.cost)) return false;
    const auto fit = FitTerms(base_, bare_, selection_, {}, Joined(fast_, alone.terms), options_);
    if (!fit) return false;
    fit->extended.Use(best_.SettingsNow());  // in the same noise
    const Eigen::VectorXd sd =
        fit->layout.Widened(fit->weighed.hypothesis.effects, fit->weighed.scales);
    return LogOdds(Standing(fit->extended, sd), beside_) > kBetterThanSeveral;
  }

  const Replay& base_;
  Replay bare_;  // the base, in the noise of the best
  Replay& best_;
  const Selection& selection_;
  const WeighedHypothesis& known_;
  const DiagnoseOptions& options_;
  std::vector<FoundTerm> fast_;
  TermSearch beside_;
};

}  // namespace

std::unique_ptr<TermModel> FindTerms(const Replay& base, Replay& best, const Selection& selection,
                                     const WeighedHypothesis& known,
                                     const DiagnoseOptions& options) {
  return TermChoice(base, best, selection, known, options).Make();
}

}  // namespace flextip::diagnosis
