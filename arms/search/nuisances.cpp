#include "arms/search/nuisances.h"

#include <vector>

#include "core/linear_algebra.h"

namespace flextip::arms {
namespace {

/// The parameters with those of `free` where they fit, about where the replay is.
Eigen::VectorXd FitSome(const Replay& replay, const Noise& noise, const std::vector<int>& free) {
  const auto size = Eigen::Index(free.size());
  const Eigen::VectorXd sd = replay.GetLayout().Prior().Tolerances()(free);
  Eigen::MatrixXd H = Eigen::MatrixXd::Identity(size, size);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    const Eigen::Index C = channel.Components();
    const Eigen::MatrixXd X = channel.derivative(Eigen::all, free) * sd.asDiagonal();
    for (Eigen::Index k = 0; k < channel.Rows(); ++k)
      for (Eigen::Index c = 0; c < C; ++c) {
        if (!noise[i].keep(k, c)) continue;
        const double by = 1.0 / noise[i].sd[c];
        const Eigen::VectorXd row = by * X.row(k * C + c).transpose();
        const double z =
            by * channel.residual(k, c) + row.dot(replay.Theta()(free).cwiseQuotient(sd));
        H.noalias() += row * row.transpose();
        g.noalias() += z * row;
      }
  }
  Eigen::VectorXd theta = replay.Theta();
  theta(free) = sd.cwiseProduct(Llt(H).Solve(g));
  return replay.GetLayout().WithinBounds(replay.Theta(), theta);
}

std::vector<int> Nuisances(const Layout& layout, bool own_alone) {
  std::vector<int> free;
  for (int b = layout.EffectCount(); b < int(layout.Blocks().size()); ++b) {
    const Layout::Block& block = layout.Blocks()[b];
    for (int j = 0; j < block.size; ++j)
      if (!own_alone || block.effect->OwnInEach()) free.push_back(block.first + j);
  }
  return free;
}

}  // namespace

void FitNuisances(Replay& replay, const Noise& noise, int rounds) {
  const std::vector<int> free = Nuisances(replay.GetLayout(), false);
  for (int round = 0; round < rounds && !free.empty(); ++round)
    replay.Evaluate(FitSome(replay, noise, free));
}

Eigen::VectorXd FitOwn(const Replay& replay, const Noise& noise) {
  const std::vector<int> free = Nuisances(replay.GetLayout(), true);
  return free.empty() ? replay.Theta() : FitSome(replay, noise, free);
}

}  // namespace flextip::arms
