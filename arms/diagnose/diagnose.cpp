#include "arms/diagnose/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "arms/diagnose/describe.h"
#include "arms/diagnose/heldout.h"
#include "arms/effects/effects.h"
#include "arms/search/adequacy.h"
#include "arms/search/nuisances.h"
#include "arms/search/search.h"
#include "core/check.h"
#include "core/error.h"

namespace flextip::arms {
namespace {

using diagnosis::Verdict;

constexpr int kBags = 8;
constexpr std::size_t kLeaders = 30;
constexpr double kKnown = 0.05;  // probability left to known answers that do not explain it

/// One recording twice would count as twice the evidence.
void RequireAnother(const ArmData& a, const ArmData& b) {
  const auto same = [](const Track& x, const Track& y) {
    return x.Rows() == y.Rows() && x.values.cols() == y.values.cols() && x.t_s == y.t_s &&
           x.values == y.values;
  };
  const bool all = same(a.joints, b.joints) && same(a.command, b.command) &&
                   same(a.seen.track, b.seen.track) && same(a.pose.track, b.pose.track) &&
                   same(a.torque.track, b.torque.track);
  if (!all) return;
  throw InputError(fmt::format("{} and {} hold the same samples, expected different recordings",
                               a.name, b.name));
}

void RequireOneArm(const std::vector<ArmData>& recordings) {
  const Arm& first = recordings.front().arm;
  for (const ArmData& data : recordings) {
    bool same = data.Size() == first.Size();
    for (int i = 0; same && i < first.Size(); ++i) {
      same = data.arm.joints[i].type == first.joints[i].type &&
             (data.arm.joints[i].before.Matrix() - first.joints[i].before.Matrix()).norm() < 1e-6;
    }
    if (!same) {
      throw InputError::At(
          data.name, 0,
          fmt::format("another arm than that of {}, expected recordings of one arm",
                      recordings.front().name));
    }
    for (const ArmData* other = recordings.data(); other != &data; ++other)
      RequireAnother(*other, data);
  }
}

void RequireKnown(const std::vector<ArmData>& recordings, const ArmOptions& options) {
  const Effects effects = MakeEffects(recordings.front().arm);
  for (const std::string& name : options.without) {
    const bool known = name == "payload" ||
                       std::any_of(effects.begin(), effects.end(),
                                   [&](const auto& effect) { return effect->Name() == name; });
    if (!known) {
      throw InputError(fmt::format(
          "{}, to be left out: no effect of that name is in the catalogue of arms", name));
    }
  }
}

std::vector<double> Softmax(const std::vector<Scored>& scored) {
  double largest = -1e300, sum = 0.0;
  for (const Scored& s : scored) largest = std::max(largest, s.log_posterior);
  std::vector<double> p;
  for (const Scored& s : scored) sum += p.emplace_back(std::exp(s.log_posterior - largest));
  for (double& value : p) value /= sum;
  return p;
}

/// Probabilities of the whole and of bags of its stretches, averaged; one for each scored
/// hypothesis.
std::vector<double> BaggedProbabilities(const Found& found, const Layout& layout,
                                        const SearchOptions& options) {
  std::vector<double> p = Softmax(found.scored);
  std::vector<std::size_t> leaders;
  for (std::size_t i = 0; i < found.scored.size(); ++i) {
    const auto& h = found.scored[i].weighed.hypothesis;
    if (leaders.size() < kLeaders || h.effects.empty()) leaders.push_back(i);
  }
  std::mt19937_64 rng(1);
  std::vector<double> bagged(p.size(), 0.0);
  const auto& blocks = found.problem.blocks;
  std::uniform_int_distribution<std::size_t> draw(0, blocks.size() - 1);
  for (int bag = 0; bag < kBags; ++bag) {
    diagnosis::NormalSums sums(found.problem.total.g.size());
    for (std::size_t b = 0; b < blocks.size(); ++b) sums.Add(blocks[draw(rng)].sums);
    const diagnosis::Evidence evidence(sums, layout.Prior(), found.generic_sd,
                                       {.scales = {0.3, 3.0}, .unknown_sd = {0.1, 0.3, 1.0}});
    std::vector<Scored> scored;
    for (const std::size_t i : leaders) {
      const auto& h = found.scored[i].weighed.hypothesis;
      scored.push_back({evidence.Weigh(h), 0.0, 0.0});
      scored.back().log_posterior = scored.back().weighed.log_evidence +
                                    LogPriorOf(h, layout.EffectCount(), options) +
                                    found.scored[i].correction;
    }
    const auto own = Softmax(scored);
    for (std::size_t i = 0; i < leaders.size(); ++i) bagged[leaders[i]] += own[i] / kBags;
  }
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = 0.5 * (p[i] + bagged[i]);
  return p;
}

/// Leaves little to known answers.
void SayUnknown(std::map<Verdict, double>& probability) {
  double& unknown = probability[{"unknown"}];
  const double known = 1.0 - unknown;
  if (known <= kKnown) return;
  for (auto& [verdict, p] : probability) p *= kKnown / known;
  unknown = 1.0 - kKnown;
}

void FillProbabilities(const std::map<Verdict, double>& probability,
                       const std::map<Verdict, double>& evidence,
                       diagnosis::DiagnosisResult& answer) {
  for (const auto& [verdict, p] : probability) {
    const auto found = evidence.find(verdict);
    answer.probabilities.push_back({verdict, p, found == evidence.end() ? 0.0 : found->second});
  }
  std::stable_sort(answer.probabilities.begin(), answer.probabilities.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  double sum = 0.0;
  for (const auto& h : answer.probabilities) {
    if (sum < 0.9) answer.credible_set.push_back(h.verdict);
    sum += h.probability;
    if (!diagnosis::NamesEffects(h.verdict)) continue;
    for (const std::string& name : h.verdict) answer.presence[name] += h.probability;
  }
  answer.verdict = answer.probabilities.front().verdict;
}

}  // namespace

std::vector<ArmParameter> ParametersOf(const diagnosis::EffectFit& fit) {
  std::vector<ArmParameter> parameters;
  parameters.reserve(fit.parameters.size());
  for (const auto& p : fit.parameters) parameters.push_back({p.name, p.value, p.sd});
  return parameters;
}

ArmResult Diagnose(const std::vector<ArmData>& recordings, const ArmOptions& options) {
  FLEXTIP_CHECK(!recordings.empty(), "a recording");
  for (const ArmData& data : recordings) data.RequireJudged();
  RequireOneArm(recordings);
  RequireKnown(recordings, options);
  const SearchOptions search_options{.parts = std::max(4, 20 / int(recordings.size()))};
  Layout layout(recordings, options.without);
  Replay extended(layout);
  const Found found = Search(extended, layout, search_options);
  Replay base = extended;  // with tracker and marker where they were found
  base.Evaluate(found.base_theta);
  FitNuisances(base, found.noise);
  const Basis basis(base);
  const Problem base_problem =
      MakeProblem(base, found.noise, basis, found.sizes, search_options.parts);

  ArmResult result;
  const auto p = BaggedProbabilities(found, layout, search_options);
  const Misfit best = MisfitOf(extended, found.noise), of_base = MisfitOf(base, found.noise);
  const bool is_unknown =
      IsUnknown(of_base, best, SquaresOfAnotherForm(extended, found, basis, search_options));
  const auto fill = [&](int only, diagnosis::DiagnosisResult& answer) {
    std::map<Verdict, double> probability{{{"none"}, 0.0}, {{"unknown"}, 0.0}}, evidence;
    for (std::size_t i = 0; i < found.scored.size(); ++i) {
      const Verdict verdict = VerdictIn(found.scored[i].weighed.hypothesis, layout, only);
      probability[verdict] += p[i];
      evidence.try_emplace(verdict, found.scored[i].weighed.log_evidence);
    }
    if (is_unknown) SayUnknown(probability);
    FillProbabilities(probability, evidence, answer);
  };
  fill(-1, result.answer);
  result.answer.base.chi2_per_dof = of_base.PerMeasurement();
  result.answer.extended.chi2_per_dof = best.PerMeasurement();
  const ArmHeldOut heldout =
      MeasureHeldOut(base, extended, found, base_problem, search_options.parts);
  Describe(base, extended, found, heldout, p, result);
  for (int r = 0; recordings.size() > 1 && r < int(recordings.size()); ++r) {
    RecordingAnswer own{recordings[r].name, {}};
    fill(r, own.answer);
    DescribeRecording(extended, found, heldout, r, result, own.answer);
    result.each.push_back(std::move(own));
  }
  return result;
}

}  // namespace flextip::arms
