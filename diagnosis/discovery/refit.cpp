#include "diagnosis/discovery/refit.h"

#include <fmt/format.h>

#include <utility>

#include "diagnosis/effects/discovered/discovered_term.h"
#include "diagnosis/evidence/generic_basis.h"
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

/// `theta` of a layout, with fewer terms or none, with the terms' values between the effects and
/// the nuisances.
Eigen::VectorXd WithTerms(const Eigen::VectorXd& theta, const TermModel& model) {
  const auto& blocks = model.layout.Blocks();
  const Eigen::Index effects = blocks[model.first_term].first;
  const auto& last = blocks[model.first_term + int(model.found.size()) - 1];
  const Eigen::Index nuisances = model.layout.Size() - last.first - last.size;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(model.layout.Size());
  all.head(effects) = theta.head(effects);
  all.tail(nuisances) = theta.tail(nuisances);
  for (std::size_t i = 0; i < model.found.size(); ++i) {
    const auto& block = blocks[model.first_term + int(i)];
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

}  // namespace

Verdict TermModel::Named() const {
  Verdict names;
  for (const int b : weighed.hypothesis.effects)
    if (b < first_term) names.push_back(layout.Blocks()[b].effect->Name());
  return names.empty() ? Verdict{"none"} : names;
}

std::vector<FoundTerm> TermModel::Fitted() const {
  std::vector<FoundTerm> fitted = found;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& block = layout.Blocks()[first_term + int(i)];
    fitted[i].term = static_cast<const DiscoveredTerm&>(*block.effect)
                         .With(extended.Theta().segment(block.first, block.size));
  }
  return fitted;
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
  if (!replay.Evaluate(WithTerms(from.Theta(), *model))) return {};
  const Rows may_miss = MayMissOf(selection);
  const Hypothesis hypothesis = HypothesisOf(*model, effects);
  Eigen::MatrixXd basis;
  for (int twice = 0; twice < 2; ++twice) {  // with the terms the noise is known better
    basis = GenericBasis(replay);
    const HypothesisFit fit = FitHypothesis(replay, model->layout, hypothesis, {},
                                            {.basis = basis,
                                             .may_miss = may_miss,
                                             .rounds = kRounds,
                                             .scans = twice == 0 ? kScans : 0,
                                             .scan_own = true});
    GoTo(replay, model->layout, fit.place);
    if (twice == 1) break;
    replay.SetNoiseScale(NoiseScale(replay));
    replay.FixNoiseModel();
  }
  Weigh(basis, may_miss, hypothesis, *model);
  model->base.TakeSettings(replay);
  model->base.SetForces(base.Forces());
  Eigen::VectorXd theta = WithTerms(base.Theta(), *model);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto& block = model->layout.Blocks()[model->first_term + int(i)];
    theta.segment(block.first, block.size).setZero();
  }
  if (!model->base.Evaluate(theta)) return {};
  return model;
}

}  // namespace flextip::diagnosis
