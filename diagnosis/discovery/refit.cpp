#include "diagnosis/discovery/refit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/effects/discovered/discovered_term.h"
#include "diagnosis/effects/discovered/term_text.h"
#include "diagnosis/evidence/generic_basis.h"
#include "diagnosis/heldout.h"
#include "diagnosis/model/geometry.h"
#include "diagnosis/samples/noise_level.h"
#include "diagnosis/search/hypothesis_fit.h"
#include "diagnosis/search/parameter_scan.h"

namespace flextip::diagnosis {
namespace {

constexpr int kRounds = 5, kScans = 3;  // with the terms the effects' own swings show anew

/// What a right form may miss of each row, as the selection had it.
Rows MayMissOf(const Selection& selection) {
  Rows terms = Rows::Zero(), sd = Rows::Zero();
  for (std::size_t j = 0; j < selection.problem.generic_row.size(); ++j) {
    const int r = selection.problem.generic_row[j];
    terms[r] += 1.0;
    sd[r] = selection.generic_sd[Eigen::Index(j)];
  }
  return sd.cwiseProduct(terms.cwiseSqrt());
}

/// `theta` of a layout with the terms' values between the effects and the nuisances.
Eigen::VectorXd WithTerms(const Eigen::VectorXd& theta, const ParameterLayout& from,
                          const TermModel& model) {
  const Eigen::Index effects = model.layout.Blocks()[model.first_term].first;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(model.layout.Size());
  all.head(effects) = theta.head(effects);
  all.tail(from.Size() - effects) = theta.tail(from.Size() - effects);
  for (std::size_t i = 0; i < model.found.size(); ++i) {
    const auto& block = model.layout.Blocks()[model.first_term + int(i)];
    all.segment(block.first, block.size) =
        static_cast<const DiscoveredTerm&>(*block.effect).Theta();
  }
  return all;
}

void Weigh(const Eigen::MatrixXd& basis, const Rows& may_miss, const Hypothesis& hypothesis,
           TermModel& model) {
  const SelectionOptions options;
  model.selection.problem = ProblemHere(model.extended, basis, options);
  model.selection.generic_sd = GenericSd(model.selection.problem, may_miss);
  const auto evidence = [&] {
    return Evidence(model.selection.problem.total, model.layout, model.selection.generic_sd,
                    {.unknown_sd = {}});
  };
  const WeighedHypothesis first = evidence().Weigh(hypothesis);
  const Eigen::VectorXd mode = evidence().Mode(first, evidence().Covariance(first));
  model.selection.memory = MemoryOfResiduals(model.extended, basis, model.selection.problem, mode);
  model.selection.problem.CountAsOne(model.selection.memory.SamplesAsOne());
  model.selection.chi2_per_dof = model.extended.ChiSquaredPerDof();
  model.weighed = evidence().Weigh(hypothesis);
}

Hypothesis HypothesisOf(const TermModel& model, std::vector<int> effects) {
  for (std::size_t i = 0; i < model.found.size(); ++i) effects.push_back(model.first_term + int(i));
  return {std::move(effects), false};
}

TermRegion RegionOf(const Term& term, const Replay& replay) {
  const std::vector<TermState> states = StatesOf(replay, term.target);
  std::vector<double> size;
  EffectMemory memory{};
  for (const TermState& state : states) {
    const TermColumns columns = ColumnsAt(term, state, memory);
    Eigen::VectorXd by =
        term.offset.size() > 0 ? term.offset : Eigen::VectorXd::Zero(term.Inputs());
    for (Eigen::Index i = 0; i < by.size(); ++i)
      for (Eigen::Index j = 0; j < columns.cols(); ++j)
        by[i] += term.amplitude(i, j) * columns(i, j);
    size.push_back(by.norm());
  }
  TermRegion region;
  region.largest = *std::max_element(size.begin(), size.end());
  region.depth_low_m = 1e9, region.depth_high_m = -1e9;
  region.p_RE_low.setConstant(1e9);
  region.p_RE_high.setConstant(-1e9);
  for (std::size_t k = 0; k < size.size(); ++k) {
    if (size[k] < 0.5 * region.largest) continue;
    region.part += 1.0 / double(size.size());
    region.depth_low_m = std::min(region.depth_low_m, states[k].scalar[1]);
    region.depth_high_m = std::max(region.depth_high_m, states[k].scalar[1]);
    const Eigen::Vector3d p = replay.Samples()[k].solved.at.segment<3>(place::kTip);
    if (!replay.Samples()[k].ok) continue;
    region.p_RE_low = region.p_RE_low.cwiseMin(p);
    region.p_RE_high = region.p_RE_high.cwiseMax(p);
  }
  return region;
}

/// What the term's variable is on the picture's axis.
double AxisOf(const Term& term, const TermState& state, Eigen::Index input) {
  switch (term.variable) {
    case TermVariable::kOwnValue:
      return state.own[input];
    case TermVariable::kPosition:
      if (term.shape == TermShape::kInversePower)
        return (state.position - Eigen::Vector3d(term.at[0], term.at[1], term.at[2])).norm();
      if (term.shape == TermShape::kPastPlane)
        return Eigen::Vector3d(term.at[0], term.at[1], term.at[2]).normalized().dot(state.position);
      return state.position[std::min<Eigen::Index>(input, 2)];
    case TermVariable::kOrientation:
      return state.orientation[std::min<Eigen::Index>(input, 2)];
    case TermVariable::kImagePosition:
      return state.image[std::min<Eigen::Index>(input, 1)];
    default:
      return state.scalar[static_cast<std::size_t>(term.variable)];
  }
}

TermPicture PictureOf(const Term& term, const Replay& replay) {
  const ResidualProblem problem(replay, replay.Layout().Tolerances(), 1);
  const std::vector<TermState> states = StatesOf(replay, term.target);
  Eigen::VectorXd direction = DirectionOf(term);
  Eigen::Index main = 0;
  direction.cwiseAbs().maxCoeff(&main);
  if (term.IsByInput()) direction = Eigen::VectorXd::Unit(term.Inputs(), main);
  const Eigen::VectorXd by = problem.ByTarget(term.target) * direction;
  const Eigen::VectorXd left = problem.LeftHere();
  TermPicture picture;
  EffectMemory memory{};
  for (std::size_t k = 0; k < states.size(); ++k) {
    const TermColumns columns = ColumnsAt(term, states[k], memory);
    const int first = problem.FirstRowOfSample(k), count = problem.FirstRowOfSample(k + 1) - first;
    const double squares = by.segment(first, count).squaredNorm();
    if (count == 0 || !(squares > 0.0)) continue;
    double value = term.offset.size() > 0 ? direction.dot(term.offset) : 0.0;
    for (Eigen::Index i = 0; i < direction.size(); ++i)
      value += direction[i] * term.amplitude.row(i).dot(columns.row(i));
    picture.variable.push_back(AxisOf(term, states[k], main));
    picture.term.push_back(value);
    picture.measured.push_back(value +
                               by.segment(first, count).dot(left.segment(first, count)) / squares);
  }
  return picture;
}

std::vector<TermName> NamesOf(const std::vector<Candidate>& rivals) {
  std::vector<TermName> names;
  names.reserve(rivals.size());
  for (const Candidate& rival : rivals) names.push_back(NameOf(rival.term));
  return names;
}

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

Verdict TermModel::Named() const {
  Verdict names;
  for (const int b : weighed.hypothesis.effects)
    if (b < first_term) names.push_back(layout.Blocks()[b].effect->Name());
  return names.empty() ? Verdict{"none"} : names;
}

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

TermName NameOf(const Term& term) {
  TermName name{InfoOf(term.target).channel, {}, Name(FormOf(term))};
  for (const TermVariable variable : DependsOn(term)) name.depends_on.emplace_back(Name(variable));
  return name;
}

TermModel::TermModel(const SampleSet& samples, Catalogue catalogue, int terms)
    : layout(samples, std::move(catalogue)),
      base(samples, layout),
      extended(samples, layout),
      first_term(layout.EffectCount() - terms) {}

std::unique_ptr<TermModel> FitTerms(const Replay& base, const Replay& from,
                                    const Selection& selection, const std::vector<int>& effects,
                                    const std::vector<FoundTerm>& found,
                                    const DiagnoseOptions& options) {
  EffectMakers makers = options.own_effects;
  for (std::size_t i = 0; i < found.size(); ++i) {
    std::vector<double> at_sd;
    for (const int at : RefinedAt(found[i].term))
      at_sd.push_back(std::size_t(at) < found[i].at_sd.size() ? found[i].at_sd[std::size_t(at)]
                                                              : 0.0);
    makers.emplace_back([&found, i, at_sd] {
      return std::make_unique<DiscoveredTerm>(found[i].term, fmt::format("discovered_{}", i + 1),
                                              at_sd);
    });
  }
  const SampleSet& samples = from.Set();
  auto model = std::make_unique<TermModel>(samples, MakeCatalogue(samples, options.without, makers),
                                           int(found.size()));
  model->found = found;
  SetScanCentres(model->layout, ScanCentres(from.Layout()));
  Replay& replay = model->extended;
  replay.TakeSettings(from);
  replay.SetForces(from.Forces());
  if (!replay.Evaluate(WithTerms(from.Theta(), from.Layout(), *model))) return {};
  const Rows may_miss = MayMissOf(selection);
  const Hypothesis hypothesis = HypothesisOf(*model, effects);
  Eigen::MatrixXd basis;
  for (int twice = 0; twice < 2; ++twice) {  // with the terms the noise is known better
    basis = GenericBasis(replay);
    const HypothesisFit fit = FitHypothesis(replay, model->layout, hypothesis, {},
                                            {.basis = basis,
                                             .may_miss = may_miss,
                                             .rounds = kRounds,
                                             .scans = twice == 0 ? kScans : 0});
    GoTo(replay, model->layout, fit.place);
    if (twice == 1) break;
    replay.SetNoiseScale(NoiseScale(replay));
    replay.FixNoiseModel();
  }
  Weigh(basis, may_miss, hypothesis, *model);
  model->base.TakeSettings(replay);
  model->base.SetForces(base.Forces());
  Eigen::VectorXd theta = WithTerms(base.Theta(), base.Layout(), *model);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& block = model->layout.Blocks()[model->first_term + int(i)];
    theta.segment(block.first, block.size).setZero();
  }
  if (!model->base.Evaluate(theta)) return {};
  return model;
}

std::vector<Discovered> DescribeTerms(const TermModel& model, bool measure_gain) {
  const Evidence evidence(model.selection.problem.total, model.layout, model.selection.generic_sd,
                          {.unknown_sd = {}});
  const Eigen::MatrixXd covariance = evidence.Covariance(model.weighed);
  std::vector<Discovered> all;
  for (std::size_t i = 0; i < model.found.size(); ++i) {
    const int block_index = model.first_term + int(i);
    const auto& block = model.layout.Blocks()[block_index];
    const auto& effect = static_cast<const DiscoveredTerm&>(*block.effect);
    Discovered one;
    one.term = effect.With(model.extended.Theta().segment(block.first, block.size));
    one.name = NameOf(one.term);
    one.frame = InfoOf(one.term.target).frame;
    one.direction = DirectionOf(one.term);
    one.parameters =
        TermParameters(one.term, covariance.block(block.first, block.first, block.size, block.size),
                       model.found[i].at_sd);
    one.text = TextOf(one.term);
    one.false_discovery = model.found[i].false_discovery;
    one.stability = model.found[i].stability;
    one.could_be = NamesOf(model.found[i].rivals);
    one.region = RegionOf(one.term, model.extended);
    one.picture = PictureOf(one.term, model.extended);
    if (measure_gain) {
      Hypothesis rest = model.weighed.hypothesis;
      std::erase(rest.effects, block_index);
      const HeldOut with =
          MeasureHeldOut(model.base, model.extended, model.selection, model.weighed);
      const HeldOut without =
          MeasureHeldOut(model.base, model.extended, model.selection, evidence.Weigh(rest));
      one.gain.measured = with.gain.measured && without.extended.weighted_rms > 0.0;
      if (one.gain.measured)
        one.gain.heldout_error_ratio = with.extended.weighted_rms / without.extended.weighted_rms;
      if (without.extended.tip_prediction_rms_m > 0.0)
        one.gain.tip_error_ratio =
            with.extended.tip_prediction_rms_m / without.extended.tip_prediction_rms_m;
    }
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace flextip::diagnosis
