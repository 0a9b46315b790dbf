#include "diagnosis/prediction/found_again.h"

#include <cmath>
#include <numbers>

#include "core/linear_algebra.h"
#include "diagnosis/evidence/linear_problem.h"

namespace flextip::diagnosis {
namespace {

constexpr int kRounds = 4;
constexpr double kAtRest = 0.1;  // of a parameter's standard deviation
constexpr int kTurns = 72;       // phases that are tried

/// The parameters that are found by a linear fit, and their priors.
struct Free {
  std::vector<int> parameters;
  Eigen::VectorXd sd;
};

Free FreeOf(const ParameterLayout& layout, const std::vector<int>& present) {
  Free free;
  std::vector<double> sd;
  for (const auto& block : layout.Blocks()) {
    if (!block.nuisance) continue;
    for (int j = block.first; j < block.first + block.size; ++j) {
      free.parameters.push_back(j);
      sd.push_back(layout.Tolerances()[j]);
    }
  }
  for (const int b : present) {
    const auto& block = layout.Blocks()[b];
    for (const int own : block.effect->StateParameters()) {
      free.parameters.push_back(block.first + own);
      sd.push_back(layout.Parameter(block.first + own).typical);
    }
  }
  free.sd = Eigen::Map<Eigen::VectorXd>(sd.data(), Eigen::Index(sd.size()));
  return free;
}

/// `theta` with the free parameters at their best; `squares`: what is left then, up to a constant.
struct BestFree {
  Eigen::VectorXd theta;
  double squares = 0.0;
};

BestFree FitFree(const NormalSums& sums, const Free& free, Eigen::VectorXd theta) {
  for (const int j : free.parameters) theta[j] = 0.0;
  const Eigen::VectorXd g = sums.g - sums.H * theta;
  const double squares = -2.0 * sums.g.dot(theta) + theta.dot(sums.H * theta);
  if (free.parameters.empty()) return {theta, squares};
  Eigen::MatrixXd M = free.sd.asDiagonal() *
                      Eigen::MatrixXd(sums.H(free.parameters, free.parameters)) *
                      free.sd.asDiagonal();
  M.diagonal().array() += 1.0;
  const Eigen::VectorXd own = free.sd.asDiagonal() * Eigen::VectorXd(g(free.parameters));
  const Eigen::VectorXd best = Llt(M).Solve(own);
  for (std::size_t i = 0; i < free.parameters.size(); ++i)
    theta[free.parameters[i]] = free.sd[Eigen::Index(i)] * best[Eigen::Index(i)];
  return {theta, squares - own.dot(best)};
}

/// The best turn of the block's phase from where it is in `theta`.
BestFree FitPhase(const NormalSums& sums, const Free& free, const ParameterLayout::Block& block,
                  const BestFree& from) {
  BestFree best = from;
  double step = 2.0 * std::numbers::pi / kTurns;
  const auto try_turn = [&](double turn_rad) {
    Eigen::VectorXd turned = from.theta;
    turned.segment(block.first, block.size) =
        block.effect->TurnPhase(from.theta.segment(block.first, block.size), turn_rad);
    const BestFree tried = FitFree(sums, free, turned);
    if (tried.squares >= best.squares) return false;
    best = tried;
    return true;
  };
  double at = 0.0;
  for (int i = 1; i < kTurns; ++i)
    if (try_turn(i * step)) at = i * step;
  for (int halved = 0; halved < 12; ++halved) {
    step *= 0.5;
    if (try_turn(at + step)) {
      at += step;
    } else if (try_turn(at - step)) {
      at -= step;
    }
  }
  return best;
}

}  // namespace

bool FindAgain(Replay& replay, const Eigen::VectorXd& theta, const std::vector<int>& present) {
  const ParameterLayout& layout = replay.Layout();
  const Free free = FreeOf(layout, present);
  if (!replay.Evaluate(theta)) return false;
  for (int round = 0; round < kRounds; ++round) {
    const NormalSums sums = MakeLinearProblem(replay, {}, 1).total;
    BestFree best = FitFree(sums, free, replay.Theta());
    for (const int b : present)
      if (layout.Blocks()[b].effect->HasPhase())
        best = FitPhase(sums, free, layout.Blocks()[b], best);
    const Eigen::VectorXd step = best.theta - replay.Theta();
    replay.PredictForces(step);
    if (!replay.Evaluate(best.theta)) return false;
    double farthest = 0.0;
    for (int j = 0; j < layout.Size(); ++j)
      farthest = std::max(farthest, std::abs(step[j]) * std::sqrt(sums.H(j, j)));
    if (farthest < kAtRest) break;
  }
  return true;
}

}  // namespace flextip::diagnosis
