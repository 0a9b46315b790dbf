#include "diagnosis/discovery/discover.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/discovery/certify.h"
#include "diagnosis/discovery/library.h"

namespace flextip::diagnosis {
namespace {

constexpr int kMostQuiet = 3;
constexpr double kMostlyConstant = 0.98;  // of what a form explains: the rest is another term

std::vector<double> Weights(int blocks, int parity) {
  std::vector<double> weight(static_cast<std::size_t>(blocks), 1.0);
  for (int b = 0; b < blocks; ++b)
    if (parity >= 0 && b % 2 != parity) weight[static_cast<std::size_t>(b)] = 0.0;
  return weight;
}

/// Twice the smaller of two probabilities: that what is chosen on one half holds on the other by
/// chance, and the other way round (Bonferroni: of two looks the luckier counts double).
double CertifyByHalves(const ResidualProblem& problem, const StatesByTarget& states,
                       bool fast_waves_only) {
  double least = 0.5;
  for (const int seen : {0, 1}) {
    const auto weight = Weights(problem.Blocks(), seen);
    const WeightedProblem half(problem, weight);
    const std::vector<Candidate> chosen = FindCandidates(half, states, fast_waves_only);
    if (chosen.empty() || chosen.front().criterion <= 0.0) continue;
    least = std::min(least, FalseDiscovery(problem, chosen.front().term, weight,
                                           Weights(problem.Blocks(), 1 - seen)));
  }
  return 2.0 * least;
}

/// Without the constant where it is not worth its numbers.
void DropOffset(const WeightedProblem& weighted, const StatesByTarget& states, double variance,
                Candidate& best) {
  if (best.term.shape == TermShape::kConstant) return;
  Candidate bare{best.term};
  const TargetScan scan(weighted, best.term.target, false);
  bare.gain = scan.Gain(bare.term, SeriesOf(best.term, states.at(best.term.target)));
  const double worth = best.term.Inputs() * std::log(weighted.samples);
  if ((best.gain - bare.gain) / variance > worth) return;
  best.term = bare.term;
  best.gain = bare.gain;
}

bool SameForm(const Term& a, const Term& b) {
  return a.target == b.target && DependsOn(a) == DependsOn(b) && FormOf(a) == FormOf(b);
}

std::vector<Candidate> RivalsOf(const std::vector<Candidate>& candidates, double alike) {
  std::vector<Candidate> rivals;
  for (std::size_t i = 1; i < candidates.size(); ++i) {
    if (candidates[i].criterion < candidates[0].criterion - alike) break;
    bool said = SameForm(candidates[i].term, candidates[0].term);
    for (const Candidate& rival : rivals) said |= SameForm(candidates[i].term, rival.term);
    if (!said) rivals.push_back(candidates[i]);
  }
  return rivals;
}

/// What the base leaves with its parameters within their tolerances.
double BaseCost(const Replay& replay, int blocks) {
  const ResidualProblem problem(replay, replay.Layout().Tolerances(), blocks);
  return WeightedProblem(problem, Weights(blocks, -1)).cost;
}

}  // namespace

double LogOdds(const TermSearch& one, const TermSearch& other) {
  const double variance = std::max(1.0, std::min(one.cost, other.cost) / std::max(1.0, one.rows));
  return (other.cost - one.cost) / variance + other.complexity - one.complexity;
}

TermSearch SearchTerms(const Replay& replay, const Eigen::VectorXd& prior_sd,
                       const std::vector<FoundTerm>& before, const DiscoverOptions& options) {
  ResidualProblem problem(replay, prior_sd, options.blocks);
  StatesByTarget states;
  for (const TermTarget target : TargetsOf(replay.Set())) states[target] = StatesOf(replay, target);
  const auto free = [&](const Term& term) {
    problem.Free(
        problem.Moved(term, SeriesOf(term, states.at(term.target)), term.offset.size() > 0));
  };
  const double base = BaseCost(replay, options.blocks);
  TermSearch search;
  for (const FoundTerm& known : before) free(known.term);
  const int most = options.most_terms - int(before.size());
  int quiet = 0;
  for (int i = 0;; ++i) {
    const WeightedProblem all(problem, Weights(problem.Blocks(), -1));
    search.cost = all.cost;
    search.rows = all.rows;
    if (i == 0) search.complexity = Llt(all.information).LogDeterminant();
    if (int(search.terms.size()) >= most) break;
    const std::vector<Candidate> candidates = FindCandidates(all, states, options.fast_waves_only);
    if (candidates.empty()) break;
    Candidate best = candidates.front();
    const bool is_first = before.empty() && search.terms.empty();
    const LeastTerm& limit = is_first ? options.least_first : options.least;
    const double least_left = limit.left * all.cost;
    const double least = std::max(limit.part * base, least_left);
    const auto completes = [&](const Candidate& one) {
      return one.gain >= least_left && std::ranges::any_of(options.completed, [&](const Term& of) {
               return SameForm(one.term, of);
             });
    };
    const auto counts = [&](const Candidate& one) {
      return one.criterion >= options.worth && (one.gain >= least || completes(one));
    };
    if (!counts(best)) break;
    const auto constant = std::ranges::find_if(candidates, [&](const Candidate& one) {
      return one.term.target == best.term.target && one.term.shape == TermShape::kConstant;
    });
    const double of_constant = constant == candidates.end() ? 0.0 : constant->gain;
    const auto matters = [&](const Candidate& one) {
      const bool varies = one.term.shape != TermShape::kConstant;
      const bool is_much = varies && one.gain - of_constant >= options.much_left * all.cost;
      return counts(one) && (completes(one) || is_much ||
                             HalfRange(one.term, states.at(one.term.target)) >= limit.tolerances);
    };
    // What varies too little may stand beside a constant that does not.
    if (constant != candidates.end() && matters(*constant) &&
        (!matters(best) || of_constant >= kMostlyConstant * best.gain))
      best = *constant;
    const double variance = VarianceLeft(all, best.gain);
    if (!matters(best)) {
      if (++quiet > kMostQuiet) break;
      search.complexity += best.gain / variance - best.criterion;
      free(best.term);  // within tolerance: there, and no matter
      continue;
    }
    FoundTerm found{.at_sd = best.at_sd};
    if (options.certify) {
      const double as_one = SamplesAsOne(problem, best.term, states);
      if (Criterion(best, variance * as_one, all.samples) < options.worth) break;
      found.false_discovery = CertifyByHalves(problem, states, options.fast_waves_only);
      if (found.false_discovery > options.most_false) break;
      found.stability = Stability(problem, candidates, states, options.bags);
      found.rivals = RivalsOf(candidates, options.alike);
    }
    DropOffset(all, states, variance, best);
    search.complexity += best.gain / variance - best.criterion;
    found.term = best.term;
    search.terms.push_back(std::move(found));
    free(best.term);
  }
  return search;
}

}  // namespace flextip::diagnosis
