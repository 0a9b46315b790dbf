#include "diagnosis/evidence/evidence.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "diagnosis/evidence/half_normal.h"

namespace flextip::diagnosis {

double LogSumExp(const std::vector<double>& x) {
  const double largest = *std::max_element(x.begin(), x.end());
  double sum = 0.0;
  for (const double value : x) sum += std::exp(value - largest);
  return largest + std::log(sum);
}

Evidence::Evidence(const NormalSums& sums, const Priors& priors, const Eigen::VectorXd& generic_sd,
                   const EvidenceOptions& options)
    : sums_(sums), priors_(priors), options_(options), narrow_(sums.g.size()) {
  narrow_ << priors.Tolerances(), generic_sd;
  std::vector<double> widths{0.0};
  if (generic_sd.size() > 0)
    widths.insert(widths.end(), options.unknown_sd.begin(), options.unknown_sd.end());
  contexts_.resize(widths.size());
  tbb::parallel_for(std::size_t{0}, widths.size(),
                    [&](std::size_t i) { contexts_[i] = MakeContext(widths[i]); });
  none_ = contexts_[0].log_evidence - 0.5 * (sums.c + sums.volume);
  for (std::size_t i = contexts_.size(); i-- > 0;)
    contexts_[i].log_evidence -= contexts_[0].log_evidence;
}

Evidence::Context Evidence::MakeContext(double unknown_sd) const {
  Context context{unknown_sd, narrow_, {}, {}, 0.0};
  for (int j = priors_.Size(); j < int(narrow_.size()); ++j)
    context.sd[j] = std::max(narrow_[j], unknown_sd);
  Eigen::MatrixXd M = context.sd.asDiagonal() * sums_.H * context.sd.asDiagonal();
  M.diagonal().array() += 1.0;
  const Llt llt(M);
  const Eigen::VectorXd g = context.sd.asDiagonal() * sums_.g;
  context.covariance = llt.Inverse();
  context.mean = context.covariance * g;
  context.log_evidence = 0.5 * (g.dot(context.mean) - llt.LogDeterminant());
  return context;
}

std::vector<int> Evidence::Subset(const Hypothesis& hypothesis) const {
  std::vector<int> subset;
  for (const int b : hypothesis.effects) {
    const ParameterSpan& block = priors_.Span(b);
    for (int j = 0; j < block.size; ++j) subset.push_back(block.first + j);
  }
  return subset;
}

Evidence::Marginal Evidence::MarginalOf(const Context& context, const std::vector<int>& subset) {
  const Eigen::MatrixXd C = context.covariance(subset, subset);
  const Eigen::VectorXd mean = context.mean(subset);
  const Llt llt(C);
  Marginal marginal;
  marginal.A = llt.Inverse();
  marginal.eta = llt.Solve(mean);
  marginal.base = marginal.eta.dot(mean) + llt.LogDeterminant();
  return marginal;
}

Eigen::VectorXd Evidence::WideSd(const std::vector<int>& subset, const Hypothesis& hypothesis,
                                 const std::vector<double>& scales) const {
  const Eigen::VectorXd sd = priors_.Widened(hypothesis.effects, scales);
  Eigen::VectorXd wide(Eigen::Index(subset.size()));
  for (std::size_t i = 0; i < subset.size(); ++i)
    wide[Eigen::Index(i)] = sd[subset[i]] / narrow_[subset[i]];
  return wide;
}

/// Twice the log evidence with prior `wide` instead of one, both in units of the narrow prior;
/// parameters that cannot be negative have half a normal for their prior.
double Evidence::Change(const Marginal& marginal, const Eigen::VectorXd& wide,
                        const std::vector<int>& subset) const {
  const Eigen::VectorXd precision = wide.cwiseAbs2().cwiseInverse();
  Eigen::MatrixXd M = marginal.A;
  M.diagonal().array() += precision.array() - 1.0;
  const Llt llt(M);
  if (!llt.Succeeded()) return -1e300;
  const Eigen::VectorXd mean = llt.Solve(marginal.eta);
  double twice = marginal.eta.dot(mean) - llt.LogDeterminant() - 2.0 * wide.array().log().sum() -
                 marginal.base;
  std::vector<int> positive;
  for (std::size_t i = 0; i < subset.size(); ++i)
    if (priors_.Parameter(subset[i]).positive) positive.push_back(int(i));
  if (positive.empty()) return twice;
  const Eigen::MatrixXd C = llt.Inverse();
  twice += 2.0 * (double(positive.size()) * std::log(2.0) + LogPositive(mean, C, positive));
  return twice;
}

WeighedHypothesis Evidence::Weigh(const Hypothesis& hypothesis) const {
  WeighedHypothesis weighed{hypothesis, 0.0, {}, 0.0};
  const auto subset = Subset(hypothesis);
  const std::size_t effects = hypothesis.effects.size();
  std::size_t combinations = 1;
  for (std::size_t i = 0; i < effects; ++i) combinations *= options_.scales.size();
  std::vector<double> logs;
  double best = -1e300;
  for (const Context& context : contexts_) {
    if ((context.unknown_sd > 0.0) != hypothesis.unknown) continue;
    const Marginal marginal = MarginalOf(context, subset);
    for (std::size_t c = 0; c < combinations; ++c) {
      std::vector<double> scales(effects);
      std::size_t rest = c;
      for (double& scale : scales) {
        scale = options_.scales[rest % options_.scales.size()];
        rest /= options_.scales.size();
      }
      const double log_evidence =
          context.log_evidence + 0.5 * Change(marginal, WideSd(subset, hypothesis, scales), subset);
      logs.push_back(log_evidence);
      if (log_evidence <= best) continue;
      best = log_evidence;
      weighed.scales = scales;
      weighed.unknown_sd = context.unknown_sd;
    }
  }
  weighed.log_evidence = logs.empty() ? -1e300 : LogSumExp(logs) - std::log(double(logs.size()));
  return weighed;
}

Eigen::VectorXd Evidence::PriorSd(const WeighedHypothesis& weighed) const {
  Eigen::VectorXd sd = narrow_;
  sd.head(priors_.Size()) = priors_.Widened(weighed.hypothesis.effects, weighed.scales);
  if (weighed.hypothesis.unknown)
    sd.tail(sd.size() - priors_.Size()) =
        sd.tail(sd.size() - priors_.Size()).cwiseMax(weighed.unknown_sd);
  return sd;
}

Eigen::MatrixXd Evidence::Covariance(const WeighedHypothesis& weighed) const {
  const Eigen::VectorXd sd = PriorSd(weighed);
  Eigen::MatrixXd M = sd.asDiagonal() * sums_.H * sd.asDiagonal();
  M.diagonal().array() += 1.0;
  const Eigen::MatrixXd C = Llt(M).Inverse();
  return sd.asDiagonal() * C * sd.asDiagonal();
}

double Evidence::Merit(const WeighedHypothesis& weighed, const Eigen::VectorXd& x) const {
  return sums_.c + sums_.volume - 2.0 * sums_.g.dot(x) + x.dot(sums_.H * x) +
         x.cwiseQuotient(PriorSd(weighed)).squaredNorm();
}

Eigen::VectorXd Evidence::Mode(const WeighedHypothesis& weighed, const Eigen::MatrixXd& C) const {
  std::vector<int> positive;
  for (const int j : Subset(weighed.hypothesis))
    if (priors_.Parameter(j).positive) positive.push_back(j);
  return PositiveMode(C * sums_.g, C, positive);
}

}  // namespace flextip::diagnosis
