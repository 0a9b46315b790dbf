#include "diagnosis/discovery/discover.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/discovery/certify.h"
#include "diagnosis/discovery/library.h"

namespace flextip::diagnosis {
namespace {

std::vector<double> Weights(int blocks, int parity) {
  std::vector<double> weight(static_cast<std::size_t>(blocks), 1.0);
  for (int b = 0; b < blocks; ++b)
    if (parity >= 0 && b % 2 != parity) weight[static_cast<std::size_t>(b)] = 0.0;
  return weight;
}

/// The larger of two probabilities: that what is chosen on one half does not hold on the other, and
/// the other way round.
double CertifyByHalves(const ResidualProblem& problem, const StatesByTarget& states) {
  double worst = 0.0;
  for (const int seen : {0, 1}) {
    const auto weight = Weights(problem.Blocks(), seen);
    const WeightedProblem half(problem, weight);
    const std::vector<Candidate> chosen = FindCandidates(half, states);
    if (chosen.empty() || chosen.front().criterion <= 0.0) return 1.0;
    worst = std::max(worst, FalseDiscovery(problem, chosen.front().term, weight,
                                           Weights(problem.Blocks(), 1 - seen)));
  }
  return worst;
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

}  // namespace

double LogOdds(const TermSearch& one, const TermSearch& other) {
  const double variance = std::max(1.0, std::min(one.cost, other.cost) / std::max(1.0, one.rows));
  return (other.cost - one.cost) / variance + other.complexity - one.complexity;
}

TermSearch SearchTerms(const Replay& replay, const Eigen::VectorXd& prior_sd,
                       const DiscoverOptions& options) {
  ResidualProblem problem(replay, prior_sd, options.blocks);
  StatesByTarget states;
  for (const TermTarget target : TargetsOf(replay.Set())) states[target] = StatesOf(replay, target);
  const double squares = problem.Left().squaredNorm();
  TermSearch search;
  for (int i = 0; i <= options.most_terms; ++i) {
    const WeightedProblem all(problem, Weights(problem.Blocks(), -1));
    search.cost = all.cost;
    search.rows = all.rows;
    if (i == 0) search.complexity = Llt(all.information).LogDeterminant();
    if (i == options.most_terms) break;
    const std::vector<Candidate> candidates = FindCandidates(all, states);
    if (candidates.empty()) break;
    Candidate best = candidates.front();
    if (best.criterion < options.worth || best.gain < options.least_part * squares) break;
    const double variance = VarianceLeft(all, best.gain);
    const double false_discovery = CertifyByHalves(problem, states);
    if (false_discovery > options.most_false) break;
    const double stability = Stability(problem, candidates, states, options.bags);
    DropOffset(all, states, variance, best);
    search.complexity += best.gain / variance - best.criterion;
    search.terms.push_back(
        {best.term, best.at_sd, false_discovery, stability, RivalsOf(candidates, options.alike)});
    problem.Free(problem.Moved(best.term, SeriesOf(best.term, states.at(best.term.target)),
                               best.term.offset.size() > 0));
  }
  return search;
}

}  // namespace flextip::diagnosis
