#include "bench/diagnosis_matrix/bound.h"

#include "bench/diagnosis_matrix/rival.h"
#include "core/linear_algebra.h"

namespace flextip::bench {

Eigen::MatrixXd PosteriorCovariance(const Eigen::MatrixXd& H, const Eigen::VectorXd& prior_sd) {
  Eigen::MatrixXd M = prior_sd.asDiagonal() * H * prior_sd.asDiagonal();
  M.diagonal().array() += 1.0;
  const Eigen::MatrixXd C = Llt(M).Inverse();
  return prior_sd.asDiagonal() * C * prior_sd.asDiagonal();
}

std::vector<diagnosis::EffectFit> CramerRaoBounds(TrueModel& truth) {
  if (!truth.StandAtTruth()) return {};
  const diagnosis::LinearProblem problem = diagnosis::MakeLinearProblem(truth.replay, {}, 1);
  const Eigen::MatrixXd C =
      PosteriorCovariance(problem.total.H, WidePrior(truth.layout, truth.present));
  std::vector<diagnosis::EffectFit> bounds;
  for (const int b : truth.present) {
    const auto& block = truth.layout.Blocks()[b];
    bounds.push_back(
        {block.effect->Name(),
         block.effect->Report(truth.parameters.theta.segment(block.first, block.size),
                              C.block(block.first, block.first, block.size, block.size))});
  }
  return bounds;
}

}  // namespace flextip::bench
