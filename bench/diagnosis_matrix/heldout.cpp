#include "bench/diagnosis_matrix/heldout.h"

#include <cmath>

#include "bench/diagnosis_matrix/rival.h"
#include "core/linear_algebra.h"
#include "diagnosis/search/hypotheses.h"

namespace flextip::bench {
namespace {

constexpr int kFolds = 4;   // as MeasureHeldOut has them
constexpr int kRounds = 3;  // of the fit to the whole recording, which folds start from

/// Squares of measured rows over their noise's variances.
struct Squares {
  double sum = 0.0, count = 0.0;

  void Add(const diagnosis::Replay& replay, const std::vector<diagnosis::Rows>& residuals,
           std::size_t k) {
    if (!replay.Samples()[k].ok) return;
    const diagnosis::Rows sd = replay.RowNoise(k);
    for (int r = 0; r < diagnosis::row::kCount; ++r) {
      if (!replay.Set().samples[k].present[r]) continue;
      sum += std::pow(residuals[k][r] / sd[r], 2);
      count += 1.0;
    }
  }
};

/// One fold's stretch of time is predicted with what the others say.
void AddFold(const TrueModel& truth, const diagnosis::LinearProblem& problem,
             const Eigen::VectorXd& prior_sd, int fold, Squares& squares) {
  const int blocks = static_cast<int>(problem.blocks.size());
  diagnosis::NormalSums train(problem.Size());
  for (int b = 0; b < blocks; ++b)
    if (b * kFolds / blocks != fold) train.Add(problem.blocks[b]);
  const diagnosis::Replay& replay = truth.replay;
  const Eigen::VectorXd theta =
      FitFree(train, truth.parameters.unnamed, prior_sd, truth.parameters.theta);
  const std::vector<diagnosis::Rows> residuals =
      replay.ForceFreeResiduals({}, theta - replay.Theta());
  const std::size_t n = replay.Samples().size();
  for (int b = 0; b < blocks; ++b) {
    if (b * kFolds / blocks != fold) continue;
    for (std::size_t k = n * b / blocks; k < n * (b + 1) / blocks; ++k)
      squares.Add(replay, residuals, k);
  }
}

}  // namespace

Eigen::VectorXd FitFree(const diagnosis::NormalSums& sums, const std::vector<int>& free,
                        const Eigen::VectorXd& prior_sd, Eigen::VectorXd theta) {
  theta(free).setZero();
  const Eigen::VectorXd sd = prior_sd(free);
  const Eigen::VectorXd left = sums.g - sums.H * theta, g = sd.asDiagonal() * left(free).eval();
  Eigen::MatrixXd M = sd.asDiagonal() * sums.H(free, free).eval() * sd.asDiagonal();
  M.diagonal().array() += 1.0;
  theta(free) = sd.asDiagonal() * Eigen::VectorXd(Llt(M).Solve(g));
  return theta;
}

double TrueHeldOutError(TrueModel& truth,
                        const std::array<double, diagnosis::kChannelCount>& noise_scale) {
  if (!truth.StandAtTruth()) return 0.0;
  diagnosis::Replay& replay = truth.replay;
  replay.SetNoiseScale(noise_scale);
  const Eigen::VectorXd prior_sd = WidePrior(truth.layout, truth.present);
  for (int round = 0; round < kRounds; ++round) {
    const diagnosis::NormalSums sums = diagnosis::MakeLinearProblem(replay, {}, 1).total;
    if (!replay.Evaluate(FitFree(sums, truth.parameters.unnamed, prior_sd, truth.parameters.theta)))
      return 0.0;
  }
  const diagnosis::LinearProblem problem =
      diagnosis::MakeLinearProblem(replay, {}, diagnosis::SelectionOptions().blocks);
  Squares squares;
  for (int fold = 0; fold < kFolds; ++fold) AddFold(truth, problem, prior_sd, fold, squares);
  return squares.count > 0.0 ? std::sqrt(squares.sum / squares.count) : 0.0;
}

}  // namespace flextip::bench
