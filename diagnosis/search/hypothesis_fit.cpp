#include "diagnosis/search/hypothesis_fit.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "diagnosis/evidence/force_volume.h"
#include "diagnosis/search/parameter_scan.h"

namespace flextip::diagnosis {
namespace {

constexpr double kAtRest = 0.5;      // of a parameter's standard deviation
constexpr double kHopeless = 40.0;   // in log odds, after two rounds
constexpr double kMostUntold = 3.0;  // times a promise that may come beyond it, after one round
constexpr double kFarthest = 6.0;    // typical sizes

/// What parameters `theta` leave of the squares, without generic terms.
double SquaresLeft(const NormalSums& sums, const Eigen::VectorXd& theta) {
  const auto P = theta.size();
  return sums.c - 2.0 * sums.g.head(P).dot(theta) + theta.dot(sums.H.topLeftCorner(P, P) * theta);
}

/// Minus twice the log of how likely parameters `theta` are, the generic terms at their best.
double Merit(const LinearProblem& problem, const Eigen::VectorXd& theta,
             const Eigen::VectorXd& prior_sd, const Eigen::VectorXd& generic_sd) {
  const NormalSums& sums = problem.total;
  const auto P = theta.size(), G = sums.g.size() - P;
  const double merit =
      SquaresLeft(sums, theta) + sums.volume + theta.cwiseQuotient(prior_sd).squaredNorm();
  const Eigen::VectorXd left =
      generic_sd.asDiagonal() * (sums.g.tail(G) - sums.H.bottomLeftCorner(G, P) * theta);
  Eigen::MatrixXd M =
      generic_sd.asDiagonal() * sums.H.bottomRightCorner(G, G) * generic_sd.asDiagonal();
  M.diagonal().array() += 1.0;
  return merit - left.dot(Eigen::VectorXd(Llt(M).Solve(left)));
}

/// `mode` no further out than is plausible.
Eigen::VectorXd Plausible(Eigen::VectorXd mode, const ParameterLayout& layout) {
  for (int j = 0; j < layout.Size(); ++j) {
    const double limit = kFarthest * std::max(layout.Parameter(j).typical, layout.Tolerances()[j]);
    mode[j] = std::clamp(mode[j], -limit, limit);
  }
  return mode;
}

/// The blocks whose scanned parameters are looked for anew: those of effects that are fitted anyway
/// are not, unless said.
std::vector<int> ToScan(const ParameterLayout& layout, const Hypothesis& hypothesis, bool own_too) {
  std::vector<int> blocks = layout.ScannedBlocks();
  if (!own_too)
    std::erase_if(blocks, [&](int block) {
      return std::ranges::find(hypothesis.effects, block) != hypothesis.effects.end();
    });
  return blocks;
}

}  // namespace

Rows MayMiss(const Rows& residual_size, double part, const SelectionOptions& options) {
  return (part * residual_size).cwiseMax(options.least_discrepancy);
}

Eigen::VectorXd GenericSd(const LinearProblem& problem, const Rows& may_miss) {
  Rows terms = Rows::Zero();
  for (const int r : problem.generic_row) terms[r] += 1.0;
  Eigen::VectorXd sd(Eigen::Index(problem.generic_row.size()));
  for (Eigen::Index j = 0; j < sd.size(); ++j) {
    const int r = problem.generic_row[j];
    sd[j] = may_miss[r] / std::sqrt(terms[r]);
  }
  return sd;
}

LinearProblem ProblemHere(const Replay& replay, const Eigen::MatrixXd& basis,
                          const SelectionOptions& options) {
  LinearProblem problem = MakeLinearProblem(replay, basis, options.blocks);
  const double squares = SquaresLeft(problem.total, replay.Theta());
  problem.total.volume = ForceVolume(replay, squares, double(problem.total.rows));
  for (NormalSums& block : problem.blocks)
    block.volume = problem.total.volume * double(block.rows) / double(problem.total.rows);
  return problem;
}

Weighing Weigh(const Replay& replay, LinearProblem here, const std::vector<Hypothesis>& hypotheses,
               const SelectionOptions& options, const Rows& may_miss, bool grow) {
  const ParameterLayout& layout = replay.Layout();
  const int P = layout.Size();
  Weighing w;
  w.problem = std::move(here);
  w.generic_sd = GenericSd(w.problem, may_miss);
  const EvidenceOptions known{.unknown_sd = {}};
  const Evidence evidence(w.problem.total, layout, w.generic_sd, known);
  w.scored = Score(evidence, layout.EffectCount(), hypotheses, options);
  if (grow) w.scored = Grown(evidence, layout.EffectCount(), std::move(w.scored), options);
  const WeighedHypothesis& best = w.scored.front().weighed;
  w.log_none = evidence.LogEvidenceOfNone();
  const Eigen::MatrixXd covariance = evidence.Covariance(best);
  const Eigen::VectorXd mode = evidence.Mode(best, covariance);
  w.target = Plausible(mode.head(P), layout);
  w.prior_sd = evidence.PriorSd(best).head(P);
  const Eigen::VectorXd sd = covariance.diagonal().head(P).cwiseSqrt();
  w.distance = (w.target - replay.Theta()).cwiseQuotient(sd).cwiseAbs().maxCoeff();
  const double now = Merit(w.problem, replay.Theta(), w.prior_sd, w.generic_sd);
  w.promised = std::max(0.0, 0.5 * (now - evidence.Merit(best, mode)));
  return w;
}

std::optional<LinearProblem> MoveToTarget(Replay& replay, const Weighing& weighing,
                                          const Eigen::MatrixXd& basis,
                                          const SelectionOptions& options) {
  const Eigen::VectorXd from = replay.Theta();
  const Replay::State here = replay.Save();
  const double before = Merit(weighing.problem, from, weighing.prior_sd, weighing.generic_sd);
  for (double part = 1.0; part > 0.1; part *= 0.4) {
    const Eigen::VectorXd theta = from + part * (weighing.target - from);
    replay.PredictForces(theta - from);
    if (replay.Evaluate(theta)) {
      LinearProblem there = ProblemHere(replay, basis, options);
      if (Merit(there, theta, weighing.prior_sd, weighing.generic_sd) < before) return there;
    }
    replay.Restore(here);
  }
  return {};
}

Place PlaceOf(const Replay& replay) {
  return {replay.Theta(), replay.Forces(), ScanCentres(replay.Layout())};
}

void GoTo(Replay& replay, ParameterLayout& layout, const Place& place) {
  SetScanCentres(layout, place.scan_centres);
  replay.SetForces(place.forces_N);
  replay.Evaluate(place.theta);
}

HypothesisFit FitHypothesis(Replay& replay, ParameterLayout& layout, const Hypothesis& hypothesis,
                            const SelectionOptions& options, const FitOptions& fit_options) {
  HypothesisFit fit;
  fit.hypothesis = hypothesis;
  std::optional<LinearProblem> here;
  Eigen::VectorXd prior_sd;
  const std::vector<int> to_scan = ToScan(layout, hypothesis, fit_options.scan_own);
  for (int round = 0; round < fit_options.rounds; ++round) {
    const bool scan = round > 0 && round < fit_options.scans && !to_scan.empty();
    if (scan) ScanAgain(replay, layout, to_scan, prior_sd);
    if (scan || !here) here = ProblemHere(replay, fit_options.basis, options);
    const bool far = fit_options.scans > 0 && round == 0;
    const Rows may_miss = far ? MayMiss(here->residual_size, options.first_discrepancy, options)
                              : fit_options.may_miss;
    const Weighing weighing = Weigh(replay, std::move(*here), {hypothesis}, options, may_miss);
    fit.log_posterior = weighing.LogPosterior() - weighing.promised;
    fit.distance = weighing.distance;
    fit.place = PlaceOf(replay);
    prior_sd = weighing.prior_sd;
    if (round > 0 && round >= fit_options.scans && weighing.distance < kAtRest) break;
    const double behind = fit_options.worth - weighing.LogPosterior();
    if (round > 1 && behind > kHopeless) break;
    if (round == 1 && behind > kHopeless + kMostUntold * weighing.promised) break;
    if (round + 1 == fit_options.rounds) break;
    here = MoveToTarget(replay, weighing, fit_options.basis, options);
    if (!here) break;
  }
  return fit;
}

}  // namespace flextip::diagnosis
