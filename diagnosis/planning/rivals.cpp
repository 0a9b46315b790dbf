#include "diagnosis/planning/rivals.h"

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "diagnosis/planning/plan.h"

namespace flextip::diagnosis {
namespace {

constexpr double kRival = 0.2;  // times as likely as the best
constexpr std::size_t kMostRivals = 6, kContenders = 30;

/// The sums in the layout's parameters alone: the generic terms are integrated out with their
/// prior.
NormalSums WithoutGeneric(const NormalSums& sums, int parameters,
                          const Eigen::VectorXd& generic_sd) {
  const Eigen::Index n = parameters, m = sums.g.size() - n;
  NormalSums left(n);
  left.H = sums.H.topLeftCorner(n, n);
  left.g = sums.g.head(n);
  left.c = sums.c;
  left.volume = sums.volume;
  left.rows = sums.rows;
  if (m == 0) return left;
  const auto D = generic_sd.asDiagonal();
  Eigen::MatrixXd M = D * sums.H.bottomRightCorner(m, m) * D;
  M.diagonal().array() += 1.0;
  const Llt llt(M);
  const Eigen::MatrixXd across = D * sums.H.bottomLeftCorner(m, n);
  const Eigen::VectorXd g = D * sums.g.tail(m);
  left.H -= across.transpose() * llt.Solve(across);
  left.g -= across.transpose() * llt.Solve(g);
  left.c -= g.dot(llt.Solve(g));
  return left;
}

/// Hypotheses of the catalogue, the rivals first, and how many rivals there are.
struct Contenders {
  std::vector<Hypothesis> all;
  std::size_t rivals = 0;

  void Add(const Hypothesis& h) {
    if (std::find(all.begin(), all.end(), h) == all.end()) all.push_back(h);
  }
};

Contenders ContendersOf(const Selection& selection, const std::vector<std::vector<int>>& groups) {
  Contenders contenders;
  std::vector<const ScoredHypothesis*> known;
  for (const ScoredHypothesis& scored : selection.scored)
    if (!scored.weighed.hypothesis.unknown) known.push_back(&scored);
  const ScoredHypothesis& best = *known.front();
  for (const ScoredHypothesis* scored : known)
    if (scored->log_posterior >= best.log_posterior + std::log(kRival))
      contenders.Add(scored->weighed.hypothesis);
  for (const auto& group : groups) {
    for (std::size_t i = 1; i < group.size(); ++i) {
      Hypothesis swapped = best.weighed.hypothesis;
      std::replace(swapped.effects.begin(), swapped.effects.end(), group[0], group[i]);
      std::sort(swapped.effects.begin(), swapped.effects.end());
      contenders.Add(swapped);
    }
  }
  contenders.rivals = std::min(kMostRivals, contenders.all.size());
  for (const ScoredHypothesis* scored : known)
    if (contenders.all.size() < kContenders) contenders.Add(scored->weighed.hypothesis);
  return contenders;
}

}  // namespace

Rivals::Rivals(const Selection& selection, const ParameterLayout& layout,
               const std::vector<std::vector<int>>& groups)
    : selection_(selection),
      layout_(layout),
      known_(WithoutGeneric(selection.problem.total, layout.Size(), selection.generic_sd)) {
  const Evidence evidence(known_, layout, {}, {.unknown_sd = {}});
  const Contenders contenders = ContendersOf(selection, groups);
  contenders_ = contenders.all;
  for (std::size_t i = 0; i < contenders.rivals; ++i) {
    const WeighedHypothesis weighed = evidence.Weigh(contenders_[i]);
    rivals_.push_back({contenders_[i], evidence.Mode(weighed, evidence.Covariance(weighed))});
  }
}

std::vector<double> Rivals::LogPosteriors(const NormalSums& sums) const {
  const Evidence evidence(sums, layout_, {}, {.unknown_sd = {}});
  std::vector<double> log_posteriors(contenders_.size());
  for (const auto& scored : Score(evidence, layout_.EffectCount(), contenders_, SelectionOptions{},
                                  selection_.corrections)) {
    const auto at = std::find(contenders_.begin(), contenders_.end(), scored.weighed.hypothesis);
    log_posteriors[std::size_t(at - contenders_.begin())] = scored.log_posterior;
  }
  return log_posteriors;
}

/// One that says the same and names a further effect, which was no rival, is not wrong.
bool Rivals::IsRight(std::size_t rival, std::size_t contender) const {
  if (contender == rival) return true;
  return contender >= rivals_.size() &&
         std::ranges::includes(contenders_[contender].effects, contenders_[rival].effects) &&
         !contenders_[rival].effects.empty();
}

Rivals::LeastSure Rivals::LeastSureWith(const Eigen::MatrixXd& H) const {
  LeastSure least;
  for (std::size_t i = 0; i < rivals_.size(); ++i) {
    NormalSums sums = known_;
    sums.H += H;
    sums.g += H * rivals_[i].theta;
    const std::vector<double> logs = LogPosteriors(sums);
    std::vector<double> right, others;
    for (std::size_t j = 0; j < logs.size(); ++j)
      (IsRight(i, j) ? right : others).push_back(logs[j]);
    const double log_odds = others.empty() ? 1e300 : LogSumExp(right) - LogSumExp(others);
    if (log_odds < least.log_odds) least = {log_odds, i};
  }
  return least;
}

}  // namespace flextip::diagnosis
