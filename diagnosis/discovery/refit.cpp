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

constexpr int kRounds = 4;

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

std::vector<TermName> NamesOf(const std::vector<Candidate>& rivals) {
  std::vector<TermName> names;
  for (const Candidate& rival : rivals) names.push_back(NameOf(rival.term));
  return names;
}

}  // namespace

TermName NameOf(const Term& term) {
  TermName name{InfoOf(term.target).channel, {}, Name(FormOf(term))};
  for (const TermVariable variable : DependsOn(term)) name.depends_on.push_back(Name(variable));
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
    const HypothesisFit fit =
        FitHypothesis(replay, model->layout, hypothesis, {},
                      {.basis = basis, .may_miss = may_miss, .rounds = kRounds});
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
