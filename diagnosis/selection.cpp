#include "diagnosis/selection.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/effects/port_motion.h"
#include "diagnosis/frequency_scan.h"
#include "diagnosis/generic_basis.h"
#include "diagnosis/noise_level.h"

namespace flextip {
namespace {

constexpr double kAtRest = 0.5;        // of a parameter's standard deviation
constexpr double kNearRest = 3.0;      // where no step towards the best point explains more
constexpr int kScans = 4;              // rounds that look for a breathing frequency anew
constexpr int kSingleRounds = 2;       // rounds that allow one effect only
constexpr int kFitRounds = 4;          // of a hypothesis fitted by itself
constexpr int kLeadingSingles = 2;     // that are
constexpr double kSupported = 1.5;     // tolerances that a present effect exceeds
constexpr double kUnsupported = 30.0;  // taken off the log odds of one that does not

std::vector<Hypothesis> KnownHypotheses(int effects, bool pairs) {
  std::vector<Hypothesis> known = {{{}, false}};
  for (int i = 0; i < effects; ++i) {
    known.push_back({{i}, false});
    for (int j = i + 1; pairs && j < effects; ++j) known.push_back({{i, j}, false});
  }
  return known;
}

std::vector<Hypothesis> AllHypotheses(int effects) {
  std::vector<Hypothesis> all = KnownHypotheses(effects, true);
  all.push_back({{}, true});
  for (int i = 0; i < effects; ++i) all.push_back({{i}, true});
  return all;
}

double LogPrior(const Hypothesis& h, int effects, const SelectionOptions& options) {
  const double n = std::max(1, effects);
  if (h.unknown) return std::log(options.prior_unknown / (n + 1.0));
  if (h.effects.empty()) return std::log(options.prior_none);
  if (h.effects.size() == 1) return std::log(options.prior_singles / n);
  return std::log(options.prior_pairs / (n * std::max(1.0, n - 1.0) / 2.0));
}

/// What the right form of an effect may miss of the measurements, per generic coefficient.
Eigen::VectorXd GenericSd(const LinearProblem& problem, bool first, const SelectionOptions& o) {
  Eigen::VectorXd sd(Eigen::Index(problem.generic_row.size()));
  // The coefficients of a row share what the row may miss.
  Rows terms = Rows::Zero();
  for (const int r : problem.generic_row) terms[r] += 1.0;
  for (Eigen::Index j = 0; j < sd.size(); ++j) {
    const int r = problem.generic_row[j];
    const double size = first ? o.first_discrepancy * problem.residual_size[r]
                              : o.discrepancy * problem.signal_size[r];
    sd[j] = std::max(o.least_discrepancy, size) / std::sqrt(terms[r]);
  }
  return sd;
}

/// Looks for the breathing frequency anew; what was found before stays where it is confirmed.
void FindFrequency(Replay& replay, ParameterLayout& layout) {
  const int block = layout.Find("port_motion");
  if (block < 0) return;
  auto& motion = static_cast<PortMotion&>(layout.MutableEffect(block));
  const double found_hz = BestPortFrequency(replay);
  Eigen::VectorXd theta = replay.Theta();
  auto own = theta.segment(layout.Blocks()[block].first, layout.Blocks()[block].size);
  const double now_hz = motion.Frequency() + own[own.size() - 1];
  if (std::abs(found_hz - now_hz) < 0.6 / replay.Set().Duration()) return;
  motion.SetFrequency(found_hz);
  own.setZero();
  replay.Evaluate(theta);
}

bool Contains(const Hypothesis& h, int block) {
  return std::find(h.effects.begin(), h.effects.end(), block) != h.effects.end();
}

/// What is left to explain at the replay's point: the generic terms at their best, priors and the
/// unknown forces' volume included, as the round's linear problem has them.
double Merit(const Replay& replay, const Eigen::VectorXd& prior_sd, const Selection& round) {
  const LinearProblem here = MakeLinearProblem(replay, GenericBasis(replay), 1);
  const auto P = replay.Theta().size(), G = here.total.g.size() - P;
  const Eigen::VectorXd& theta = replay.Theta();
  double merit = replay.Whiten().e.squaredNorm() + theta.cwiseQuotient(prior_sd).squaredNorm() +
                 round.problem.total.volume.head(P).dot(theta);
  if (G != round.generic_sd.size()) return merit;  // other terms than before: none
  const Eigen::VectorXd left = round.generic_sd.asDiagonal() *
                               (here.total.g.tail(G) - here.total.H.bottomLeftCorner(G, P) * theta);
  Eigen::MatrixXd M = round.generic_sd.asDiagonal() * here.total.H.bottomRightCorner(G, G) *
                      round.generic_sd.asDiagonal();
  M.diagonal().array() += 1.0;
  return merit - left.dot(Eigen::VectorXd(M.llt().solve(left)));
}

/// Goes to `theta` and lets the unknown forces follow.
bool Follow(Replay& replay, const Eigen::VectorXd& theta) {
  replay.PredictForces(theta - replay.Theta());
  return replay.Evaluate(theta);
}

/// Goes towards `target` as far as that explains more than standing still. False: nowhere.
bool MoveTo(Replay& replay, const Eigen::VectorXd& target, const Eigen::VectorXd& prior_sd,
            const Selection& round) {
  const Eigen::VectorXd from = replay.Theta();
  const auto forces = replay.Forces();
  const double before = Merit(replay, prior_sd, round);
  for (double part = 1.0; part > 0.1; part *= 0.4) {
    if (Follow(replay, from + part * (target - from)) && Merit(replay, prior_sd, round) < before)
      return true;
    replay.SetForces(forces);
    replay.Evaluate(from);
  }
  return false;
}

/// The parameters' mean under the best hypothesis, no further out than is plausible.
Eigen::VectorXd PlausibleMean(const Evidence& evidence, const WeighedHypothesis& best,
                              const ParameterLayout& layout) {
  Eigen::VectorXd theta = evidence.Mean(best).head(layout.Size());
  for (int j = 0; j < layout.Size(); ++j) {
    const double limit = std::max(6.0 * layout.Parameter(j).typical, 6.0 * layout.Tolerances()[j]);
    theta[j] = std::clamp(theta[j], layout.Parameter(j).positive ? 0.0 : -limit, limit);
  }
  return theta;
}

/// An effect that the fit itself leaves within its tolerance is not there, whatever a linear view
/// from a place that is not quite at rest promises.
void DropUnsupported(const Replay& replay, Selection& selection) {
  const ParameterLayout& layout = replay.Layout();
  for (const int effect : selection.BestKnown().hypothesis.effects) {
    const auto& block = layout.Blocks()[effect];
    const double size = replay.Theta()
                            .segment(block.first, block.size)
                            .cwiseQuotient(layout.Tolerances().segment(block.first, block.size))
                            .cwiseAbs()
                            .maxCoeff();
    if (size > kSupported) continue;
    for (ScoredHypothesis& s : selection.scored)
      if (Contains(s.weighed.hypothesis, effect)) s.log_posterior -= kUnsupported;
  }
  std::stable_sort(selection.scored.begin(), selection.scored.end(),
                   [](const auto& a, const auto& b) { return a.log_posterior > b.log_posterior; });
}

/// One round: the problem about the replay's point, with the hypotheses of this round weighed.
void Weigh(Replay& replay, const SelectionOptions& options, bool first,
           const std::vector<Hypothesis>& hypotheses, Selection& selection) {
  selection.problem = MakeLinearProblem(replay, GenericBasis(replay), options.blocks);
  if (!first) AddForceVolume(replay, selection.problem);
  selection.generic_sd = GenericSd(selection.problem, first, options);
  selection.scored = ScoreSome(selection.problem.total, replay.Layout(), selection.generic_sd,
                               hypotheses, options, {.unknown_sd = {}});
}

/// How far the best point is from where the replay stands, in standard deviations.
double Distance(const Replay& replay, const Evidence& evidence, const WeighedHypothesis& best,
                const Eigen::VectorXd& target) {
  const Eigen::VectorXd sd = evidence.Covariance(best).diagonal().head(target.size()).cwiseSqrt();
  return ((target - replay.Theta()).cwiseQuotient(sd)).cwiseAbs().maxCoeff();
}

/// Where a replay stands, to come back to.
struct Place {
  Eigen::VectorXd theta;
  std::vector<Eigen::Vector3d> forces;
};

Place PlaceOf(const Replay& replay) { return {replay.Theta(), replay.Forces()}; }

void GoTo(Replay& replay, const Place& place) {
  replay.SetForces(place.forces);
  replay.Evaluate(place.theta);
}

/// Fits one hypothesis from where the replay stands until it rests; its evidence there.
double FitAlone(Replay& replay, const Hypothesis& hypothesis, const SelectionOptions& options,
                Selection& selection) {
  double log_posterior = -1e300;
  for (int round = 0; round < kFitRounds; ++round) {
    Weigh(replay, options, false, {hypothesis}, selection);
    const WeighedHypothesis weighed = selection.Best().weighed;
    const Evidence evidence(selection.problem.total, replay.Layout(), selection.generic_sd,
                            {.unknown_sd = {}});
    log_posterior = selection.Best().log_posterior + evidence.LogEvidenceOfNone();
    const Eigen::VectorXd target = PlausibleMean(evidence, weighed, replay.Layout());
    if (round > 0 && Distance(replay, evidence, weighed, target) < kAtRest) break;
    if (!MoveTo(replay, target, evidence.PriorSd(weighed).head(target.size()), selection)) break;
  }
  return log_posterior;
}

/// Hypotheses worth a fit of their own: the best, its parts, and the best single effects.
std::vector<Hypothesis> Leaders(const std::vector<ScoredHypothesis>& scored) {
  std::vector<Hypothesis> leaders = {scored.front().weighed.hypothesis};
  const auto add = [&](const Hypothesis& h) {
    if (std::find(leaders.begin(), leaders.end(), h) == leaders.end()) leaders.push_back(h);
  };
  for (const int effect : scored.front().weighed.hypothesis.effects) add({{effect}, false});
  if (scored.front().weighed.hypothesis.effects.size() < 2) add({{}, false});
  int singles = 0;
  for (const auto& s : scored) {
    if (s.weighed.hypothesis.effects.size() != 1 || singles == kLeadingSingles) continue;
    add(s.weighed.hypothesis);
    ++singles;
  }
  return leaders;
}

/// Where rounds lead nowhere, each leader is fitted by itself from the base simulation, and the
/// replay goes to where the best one fits.
void FitLeaders(Replay& replay, const Place& start, const SelectionOptions& options,
                Selection& selection) {
  Place best = PlaceOf(replay);
  double best_log = -1e300;
  for (const Hypothesis& leader : Leaders(selection.scored)) {
    GoTo(replay, start);
    Selection alone;
    const double log_posterior = FitAlone(replay, leader, options, alone);
    if (log_posterior <= best_log) continue;
    best_log = log_posterior;
    best = PlaceOf(replay);
    selection.leader = leader;
  }
  GoTo(replay, best);
}

}  // namespace

const WeighedHypothesis& Selection::BestKnown() const {
  for (const auto& s : scored)
    if (!s.weighed.hypothesis.unknown) return s.weighed;
  return scored.front().weighed;
}

std::vector<ScoredHypothesis> ScoreAll(const NormalSums& sums, const ParameterLayout& layout,
                                       const Eigen::VectorXd& generic_sd,
                                       const SelectionOptions& options) {
  return ScoreSome(sums, layout, generic_sd, AllHypotheses(layout.EffectCount()), options);
}

std::vector<ScoredHypothesis> ScoreSome(const NormalSums& sums, const ParameterLayout& layout,
                                        const Eigen::VectorXd& generic_sd,
                                        const std::vector<Hypothesis>& all,
                                        const SelectionOptions& options,
                                        const EvidenceOptions& evidence_options) {
  const Evidence evidence(sums, layout, generic_sd, evidence_options);
  std::vector<ScoredHypothesis> scored(all.size());
  tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
    scored[i].weighed = evidence.Weigh(all[i]);
    scored[i].log_posterior =
        scored[i].weighed.log_evidence + LogPrior(all[i], layout.EffectCount(), options);
  });
  std::stable_sort(scored.begin(), scored.end(),
                   [](const auto& a, const auto& b) { return a.log_posterior > b.log_posterior; });
  return scored;
}

Selection Select(Replay& replay, ParameterLayout& layout, const SelectionOptions& options) {
  Selection selection;
  replay.Settle(Eigen::VectorXd::Zero(layout.Size()));
  replay.AdaptForcePrior();
  const Place start = PlaceOf(replay);
  Hypothesis last{{-1}, false};
  const int port_motion = layout.Find("port_motion");
  for (selection.rounds = 1;; ++selection.rounds) {
    const int round = selection.rounds;
    if (round <= kScans && !Contains(last, port_motion)) FindFrequency(replay, layout);
    if (round >= 3 && round <= 6) replay.SetNoiseScale(NoiseScale(replay));
    // The largest effect first: far from it, a second one would only mend what is not linear.
    Weigh(replay, options, round == 1, KnownHypotheses(layout.EffectCount(), round > kSingleRounds),
          selection);
    const WeighedHypothesis best = selection.Best().weighed;
    const Evidence evidence(selection.problem.total, layout, selection.generic_sd,
                            {.unknown_sd = {}});
    const Eigen::VectorXd target = PlausibleMean(evidence, best, layout);
    const double distance = Distance(replay, evidence, best, target);
    selection.converged = round > kScans && best.hypothesis == last && distance < kAtRest;
    if (selection.converged || round == options.max_rounds) break;
    const bool again = best.hypothesis == last;
    last = best.hypothesis;
    if (!MoveTo(replay, target, evidence.PriorSd(best).head(layout.Size()), selection) &&
        round > kScans) {
      selection.converged = again && distance < kNearRest;
      break;
    }
  }
  if (!selection.converged) {
    FitLeaders(replay, start, options, selection);
    Weigh(replay, options, false, KnownHypotheses(layout.EffectCount(), true), selection);
    selection.converged = selection.Best().weighed.hypothesis == selection.leader;
  }
  // What is not linear looks unknown far from the answer: only here is that weighed.
  selection.scored = ScoreAll(selection.problem.total, layout, selection.generic_sd, options);
  DropUnsupported(replay, selection);
  return selection;
}

}  // namespace flextip
