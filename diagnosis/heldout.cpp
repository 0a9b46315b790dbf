#include "diagnosis/heldout.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "diagnosis/prediction/error_sums.h"

namespace flextip::diagnosis {
namespace {

NormalSums WithoutFold(const LinearProblem& problem, int fold, int folds) {
  NormalSums train = problem.total;
  const int blocks = int(problem.blocks.size());
  for (int b = 0; b < blocks; ++b)
    if (b * folds / blocks == fold) train.Add(problem.blocks[b], -1.0);
  return train;
}

}  // namespace

Eigen::VectorXd BaseParameters(const NormalSums& sums, const ParameterLayout& layout) {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  for (const auto& block : layout.Blocks()) {
    if (!block.nuisance) continue;
    const Eigen::VectorXd sd = layout.Tolerances().segment(block.first, block.size);
    Eigen::MatrixXd M = sd.asDiagonal() *
                        sums.H.block(block.first, block.first, block.size, block.size) *
                        sd.asDiagonal();
    M.diagonal().array() += 1.0;
    const Eigen::VectorXd g = sd.asDiagonal() * sums.g.segment(block.first, block.size);
    theta.segment(block.first, block.size) = sd.asDiagonal() * Llt(M).Solve(g);
  }
  return theta;
}

void MoveToBase(Replay& base, const std::string& name) {
  const ParameterLayout& layout = base.Layout();
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(layout.Size());
  if (!base.Evaluate(theta)) {
    throw WorkError(fmt::format(
        "{}: the nominal instrument has no equilibrium in {} of {} samples: check length, port and "
        "load",
        name, base.FailedSamples(), base.Samples().size()));
  }
  const bool uncertain = std::any_of(layout.Blocks().begin(), layout.Blocks().end(),
                                     [](const auto& block) { return block.nuisance; });
  for (int i = 0; uncertain && i < 3; ++i) {
    theta = BaseParameters(MakeLinearProblem(base, {}, 1).total, layout);
    base.Evaluate(theta);
  }
}

HeldOut MeasureHeldOut(const Replay& base, const Replay& extended, const Selection& selection,
                       const WeighedHypothesis& weighed, int folds) {
  const ParameterLayout& layout = base.Layout();
  const int blocks = int(selection.problem.blocks.size());
  const LinearProblem base_problem = MakeLinearProblem(base, {}, blocks);
  const TipRows tip(base.Set());
  const std::size_t n = base.Samples().size();
  std::vector<ErrorSums> base_sums, extended_sums;
  for (int fold = 0; fold < folds; ++fold) {
    const NormalSums base_train = WithoutFold(base_problem, fold, folds);
    const NormalSums train = WithoutFold(selection.problem, fold, folds);
    const Evidence evidence(train, layout, selection.generic_sd, {.unknown_sd = {}});
    const Eigen::VectorXd base_step = BaseParameters(base_train, layout) - base.Theta();
    const Eigen::VectorXd step =
        evidence.Mode(weighed, evidence.Covariance(weighed)).head(layout.Size()) - extended.Theta();
    std::vector<int> of_fold;
    for (int b = 0; b < blocks; ++b)
      if (b * folds / blocks == fold) of_fold.push_back(b);
    if (of_fold.empty()) continue;
    const SampleRange range{n * of_fold.front() / blocks, n * (of_fold.back() + 1) / blocks};
    const PredictionErrors base_errors(base, tip, base_step, range);
    const PredictionErrors errors(extended, tip, step, range);
    for (const int b : of_fold) {
      const std::size_t begin = n * b / blocks, end = n * (b + 1) / blocks;
      base_sums.push_back(base_errors.Sum(begin, end));
      extended_sums.push_back(errors.Sum(begin, end));
    }
  }
  HeldOut result = ScoreHeldOut(std::move(base_sums), std::move(extended_sums));
  result.base.chi2_per_dof = base.ChiSquaredPerDof();
  result.extended.chi2_per_dof = extended.ChiSquaredPerDof();
  return result;
}

HeldOut ScoreHeldOut(std::vector<ErrorSums> base, std::vector<ErrorSums> extended) {
  ErrorSums b, e;
  for (const ErrorSums& s : base) b.Add(s);
  for (const ErrorSums& s : extended) e.Add(s);
  HeldOut result;
  result.base = b.Score();
  result.extended = e.Score();
  result.gain.measured = b.Weighted() > 0.0;
  if (result.gain.measured) result.gain.heldout_error_ratio = e.Weighted() / b.Weighted();
  if (b.TipRms() > 0.0) result.gain.tip_error_ratio = e.TipRms() / b.TipRms();
  std::tie(result.gain.heldout_error_ratio_low, result.gain.heldout_error_ratio_high) =
      RatioInterval(base, extended);
  result.base_sums = std::move(base);
  result.extended_sums = std::move(extended);
  return result;
}

}  // namespace flextip::diagnosis
