#include "diagnosis/evidence/probabilities.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace flextip::diagnosis {
namespace {

constexpr double kInNoPart = 0.05;  // of the bags together

std::vector<double> Softmax(const std::vector<ScoredHypothesis>& scored, double temperature) {
  std::vector<double> p;
  p.reserve(scored.size());
  const double largest = scored.front().log_posterior;
  double sum = 0.0;
  for (const auto& s : scored) p.push_back(std::exp((s.log_posterior - largest) / temperature));
  for (const double value : p) sum += value;
  for (double& value : p) value /= sum;
  return p;
}

/// Of what is known and of what is beside something unknown so many each: where the one leads, the
/// bags must weigh the other all the same.
std::vector<Hypothesis> Leaders(const Selection& selection, const ProbabilityOptions& options) {
  std::vector<Hypothesis> leaders;
  int known = 0, unknown = 0;
  for (const auto& s : selection.scored) {
    const Hypothesis& h = s.weighed.hypothesis;
    int& count = h.unknown ? unknown : known;
    if (count < options.leaders || h.effects.empty()) leaders.push_back(h);
    ++count;
  }
  return leaders;
}

void FillCredibleSet(double credible, Probabilities& result) {
  double sum = 0.0;
  for (const auto& h : result.hypotheses) {
    result.credible_set.push_back(h.verdict);
    sum += h.probability;
    if (sum >= credible) return;
  }
}

}  // namespace

NormalSums DrawBag(const LinearProblem& problem, std::mt19937_64& rng) {
  const auto n = problem.blocks.size();
  std::vector<int> count(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    ++count[std::uniform_int_distribution<std::size_t>(0, n - 1)(rng)];
  NormalSums sums(problem.Size());
  if (problem.known.g.size() > 0) sums.Add(problem.known);
  for (std::size_t b = 0; b < n; ++b)
    if (count[b] > 0) sums.Add(problem.blocks[b], count[b]);
  return sums;
}

void SayUnknown(double known, std::map<Verdict, double>& probability) {
  double& unknown = probability.at({"unknown"});
  const double now = 1.0 - unknown;
  if (now <= known) return;
  for (auto& [verdict, p] : probability) p *= known / now;
  unknown = 1.0 - known;
}

std::map<Verdict, double> Agreed(const std::map<Verdict, double>& whole,
                                 const std::map<Verdict, double>& bagged) {
  const Verdict unknown{"unknown"};
  const auto of = [](const std::map<Verdict, double>& p, const Verdict& verdict) {
    const auto found = p.find(verdict);
    return found == p.end() ? 0.0 : found->second;
  };
  std::map<Verdict, double> agreed;
  double known = 0.0;
  for (const auto& [verdict, p] : whole) {
    agreed[verdict] = 0.5 * (p + of(bagged, verdict));
    if (verdict != unknown) known += agreed[verdict];
  }
  const double in_parts = of(bagged, unknown);
  const double p_unknown =
      in_parts < kInNoPart ? std::min(in_parts, of(whole, unknown)) : agreed[unknown];
  if (known <= 0.0) return agreed;
  for (auto& [verdict, p] : agreed)
    p = verdict == unknown ? p_unknown : p * (1.0 - p_unknown) / known;
  return agreed;
}

Verdict VerdictOf(const Hypothesis& hypothesis, const ParameterLayout& layout) {
  if (hypothesis.unknown) return {"unknown"};
  if (hypothesis.effects.empty()) return {"none"};
  Verdict verdict;
  for (const int b : hypothesis.effects) verdict.push_back(layout.Blocks()[b].effect->Name());
  std::sort(verdict.begin(), verdict.end());
  return verdict;
}

Probabilities MakeProbabilities(const Selection& selection, const ParameterLayout& layout,
                                const SelectionOptions& selection_options,
                                const ProbabilityOptions& options) {
  std::map<Verdict, double> whole, bagged, evidence;
  const auto add = [&](const std::vector<ScoredHypothesis>& scored, double weight,
                       std::map<Verdict, double>& probability) {
    const auto p = Softmax(scored, options.temperature);
    for (std::size_t i = 0; i < scored.size(); ++i) {
      const Verdict verdict = VerdictOf(scored[i].weighed.hypothesis, layout);
      probability[verdict] += weight * p[i];
      evidence.try_emplace(verdict, scored[i].weighed.log_evidence);
    }
  };
  add(selection.scored, 1.0, whole);
  const std::vector<Hypothesis> leaders = Leaders(selection, options);
  std::mt19937_64 rng(options.seed);
  for (int bag = 0; bag < options.bags; ++bag) {
    const NormalSums sums = DrawBag(selection.problem, rng);
    const Evidence of_bag(sums, layout, selection.generic_sd,
                          {.scales = {0.3, 1.0, 3.0}, .unknown_sd = {0.3, 1.0}});
    add(Score(of_bag, layout.EffectCount(), leaders, selection_options, selection.corrections),
        1.0 / options.bags, bagged);
  }
  std::map<Verdict, double> all = options.bags > 0 ? Agreed(whole, bagged) : whole;
  if (selection.chi2_per_dof > options.most_chi2_per_dof) SayUnknown(options.inadequate_known, all);
  Probabilities result;
  for (const auto& [verdict, p] : all) {
    result.hypotheses.push_back({verdict, p, evidence[verdict]});
    if (NamesEffects(verdict))
      for (const auto& name : verdict) result.presence[name] += p;
  }
  std::stable_sort(result.hypotheses.begin(), result.hypotheses.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  FillCredibleSet(options.credible, result);
  return result;
}

}  // namespace flextip::diagnosis
