#include "diagnosis/several/joint_probabilities.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace flextip::diagnosis {
namespace {

constexpr std::size_t kLeaders = 30;
constexpr double kLikelierThanNot = 0.5;

Verdict KeyOf(const JointHypothesis& h, const Fleet& fleet) {
  Verdict key = VerdictOf(Hypothesis{h.effects, h.unknown}, fleet.Layout());
  for (const Change& change : h.changes)
    key.push_back(
        fmt::format("{}@{}", fleet.Layout().Blocks()[change.effect].effect->Name(), change.first));
  return h.unknown ? Verdict{"unknown"} : key;
}

std::vector<NormalSums> Each(const std::vector<MemberSums>& sums,
                             const std::function<const NormalSums&(const MemberSums&)>& get) {
  std::vector<NormalSums> each;
  each.reserve(sums.size());
  for (const MemberSums& member : sums) each.push_back(get(member));
  return each;
}

/// What softmax gives each key.
std::map<Verdict, double> Shares(const std::vector<JointScored>& scored, const Fleet& fleet) {
  double largest = -1e300, sum = 0.0;
  for (const JointScored& s : scored) largest = std::max(largest, s.log_posterior);
  std::map<Verdict, double> shares;
  for (const JointScored& s : scored) {
    const double p = std::exp(s.log_posterior - largest);
    shares[KeyOf(s.weighed.hypothesis, fleet)] += p;
    sum += p;
  }
  for (auto& [key, p] : shares) p /= sum;
  return shares;
}

/// Something unknown by itself, beside each single effect and beside the best answer.
std::vector<JointHypothesis> Unknowns(const Fleet& fleet, const JointHypothesis& best) {
  std::vector<JointHypothesis> all;
  for (const Hypothesis& h : KnownHypotheses(fleet.EffectCount(), 1))
    all.push_back({h.effects, {}, true});
  JointHypothesis beside = best;
  beside.unknown = true;
  if (std::ranges::find(all, beside) == all.end()) all.push_back(beside);
  return all;
}

void AddUnknowns(const std::vector<std::vector<NormalSums>>& by_width, const Fleet& fleet,
                 const std::vector<JointHypothesis>& unknowns, const SelectionOptions& options,
                 std::vector<JointScored>& scored) {
  std::vector<std::vector<JointWeighed>> weighed(by_width.size());
  tbb::parallel_for(std::size_t{0}, by_width.size(), [&](std::size_t w) {
    const JointEvidence evidence(fleet, by_width[w]);
    for (const JointHypothesis& h : unknowns) weighed[w].push_back(evidence.Weigh(h));
  });
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    std::vector<double> logs;
    logs.reserve(weighed.size());
    for (const auto& of_width : weighed) logs.push_back(of_width[i].log_evidence);
    JointScored found{weighed.back()[i], 0.0};
    found.weighed.log_evidence = LogSumExp(logs) - std::log(double(logs.size()));
    found.log_posterior = found.weighed.log_evidence + LogPrior(unknowns[i], fleet, options);
    scored.push_back(found);
  }
}

double CorrectionOf(const JointHypothesis& h, const JointSelection& selection, double as_one) {
  for (const auto& [hypothesis, log] : selection.corrections)
    if (hypothesis == h) return log / as_one;
  return 0.0;
}

std::map<Verdict, double> Whole(const Fleet& fleet, const std::vector<MemberSums>& sums,
                                const JointSelection& selection, double as_one,
                                const SelectionOptions& options,
                                std::vector<JointHypothesis>& leaders) {
  const JointHypothesis& best = selection.best.weighed.hypothesis;
  const JointEvidence evidence(
      fleet, Each(sums, [](const auto& m) -> const NormalSums& { return m.narrow; }));
  std::vector<JointScored> scored = WeighAll(evidence, fleet, best, options);
  for (JointScored& s : scored)
    s.log_posterior += CorrectionOf(s.weighed.hypothesis, selection, as_one);
  std::ranges::stable_sort(scored, [](const JointScored& a, const JointScored& b) {
    return a.log_posterior > b.log_posterior;
  });
  for (const JointScored& s : scored)
    if (leaders.size() < kLeaders || s.weighed.hypothesis == JointHypothesis{})
      leaders.push_back(s.weighed.hypothesis);
  std::vector<std::vector<NormalSums>> by_width;
  for (std::size_t w = 0; w < kUnknownWidths.size(); ++w)
    by_width.push_back(Each(sums, [&](const auto& m) -> const NormalSums& { return m.wide[w]; }));
  AddUnknowns(by_width, fleet, Unknowns(fleet, best), options, scored);
  return Shares(scored, fleet);
}

std::map<Verdict, double> Bagged(const Fleet& fleet, const std::vector<MemberSums>& sums,
                                 const JointSelection& selection, double as_one,
                                 const SelectionOptions& options,
                                 const std::vector<JointHypothesis>& leaders) {
  const std::size_t bags = sums.front().bags.size();
  std::vector<std::map<Verdict, double>> of_bag(bags);
  tbb::parallel_for(std::size_t{0}, bags, [&](std::size_t bag) {
    const JointEvidence evidence(
        fleet, Each(sums, [&](const auto& m) -> const NormalSums& { return m.bags[bag]; }));
    std::vector<JointScored> scored;
    for (const JointHypothesis& h : leaders) {
      const JointWeighed weighed = evidence.Weigh(h);
      scored.push_back({weighed, weighed.log_evidence + LogPrior(h, fleet, options) +
                                     CorrectionOf(h, selection, as_one)});
    }
    AddUnknowns({Each(sums, [&](const auto& m) -> const NormalSums& { return m.wide_bags[bag]; })},
                fleet, Unknowns(fleet, selection.best.weighed.hypothesis), options, scored);
    of_bag[bag] = Shares(scored, fleet);
  });
  std::map<Verdict, double> mean;
  for (const auto& shares : of_bag)
    for (const auto& [key, p] : shares) mean[key] += p / double(bags);
  return mean;
}

/// The key's part that is in all recordings.
Verdict CommonOf(const Verdict& key) {
  Verdict common;
  for (const std::string& name : key)
    if (name.find('@') == std::string::npos) common.push_back(name);
  return common;
}

std::vector<ProbableChange> ChangesOf(const std::map<Verdict, double>& probability,
                                      const Fleet& fleet) {
  std::vector<ProbableChange> found;
  for (int e = 0; e < fleet.EffectCount(); ++e) {
    double any = 0.0;
    ProbableChange most{{e, 0}, 0.0};
    for (int first = 1; first < int(fleet.Size()); ++first) {
      const std::string name =
          fmt::format("{}@{}", fleet.Layout().Blocks()[e].effect->Name(), first);
      double here = 0.0;
      for (const auto& [key, p] : probability)
        if (std::ranges::find(key, name) != key.end()) here += p;
      any += here;
      if (here > most.probability) most = {{e, first}, here};
    }
    if (any > kLikelierThanNot) found.push_back(most);
  }
  std::ranges::stable_sort(found, [](const ProbableChange& a, const ProbableChange& b) {
    return a.change.first < b.change.first;
  });
  return found;
}

void FillCommon(const std::map<Verdict, double>& probability, const ProbabilityOptions& options,
                Probabilities& common) {
  std::map<Verdict, double> by_common;
  for (const auto& [key, p] : probability) by_common[CommonOf(key)] += p;
  for (const auto& [verdict, p] : by_common) {
    common.hypotheses.push_back({verdict, p, 0.0});
    if (NamesEffects(verdict))
      for (const auto& name : verdict) common.presence[name] += p;
  }
  std::ranges::stable_sort(common.hypotheses, [](const auto& a, const auto& b) {
    return a.probability > b.probability;
  });
  double sum = 0.0;
  for (const auto& h : common.hypotheses) {
    common.credible_set.push_back(h.verdict);
    sum += h.probability;
    if (sum >= options.credible) break;
  }
}

}  // namespace

JointProbabilities MakeJointProbabilities(const Fleet& fleet, const std::vector<MemberSums>& sums,
                                          const JointSelection& selection,
                                          const SelectionOptions& options) {
  const ProbabilityOptions probability_options;
  double as_one = 0.0, chi2 = 0.0;
  for (const MemberSums& member : sums) {
    as_one += member.samples_as_one / double(sums.size());
    chi2 += member.chi2_per_dof / double(sums.size());
  }
  std::vector<JointHypothesis> leaders;
  std::map<Verdict, double> all = Whole(fleet, sums, selection, as_one, options, leaders);
  if (!sums.front().bags.empty())
    all = Agreed(all, Bagged(fleet, sums, selection, as_one, options, leaders));
  if (chi2 > probability_options.most_chi2_per_dof)
    SayUnknown(probability_options.inadequate_known, all);
  JointProbabilities result;
  FillCommon(all, probability_options, result.common);
  result.changes = ChangesOf(all, fleet);
  JointHypothesis answer;
  for (const auto& h : result.common.hypotheses) {  // the best that names known effects alone
    if (h.verdict == Verdict{"unknown"}) continue;
    if (NamesEffects(h.verdict))
      for (const auto& name : h.verdict) answer.effects.push_back(fleet.Layout().Find(name));
    break;
  }
  std::sort(answer.effects.begin(), answer.effects.end());
  for (const ProbableChange& change : result.changes) answer.changes.push_back(change.change);
  const JointEvidence evidence(
      fleet, Each(sums, [](const auto& m) -> const NormalSums& { return m.narrow; }));
  result.answer = evidence.Weigh(answer);
  return result;
}

}  // namespace flextip::diagnosis
