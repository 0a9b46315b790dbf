#include "arms/search/misfit.h"

namespace flextip::arms {
namespace {

/// Of `part` residuals less what the step moves.
double Squares(const Replay& replay, const Noise& noise, const Eigen::VectorXd& step, double part) {
  double sum = 0.0;
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const Channel& channel = replay.Channels()[i];
    const Eigen::VectorXd by = channel.derivative * step;
    const Eigen::Index C = channel.Components();
    for (Eigen::Index k = 0; k < channel.Rows(); ++k)
      for (Eigen::Index c = 0; c < C; ++c) {
        if (!noise[i].keep(k, c)) continue;
        const double left = part * channel.residual(k, c) - by[k * C + c];
        sum += left * left / (noise[i].floor[c] * noise[i].floor[c]);
      }
  }
  return sum;
}

}  // namespace

double SquaresAfter(const Replay& replay, const Noise& noise, const Eigen::VectorXd& step) {
  return Squares(replay, noise, step, 1.0);
}

double SquaresOf(const Replay& replay, const Noise& noise, const Eigen::VectorXd& step) {
  return Squares(replay, noise, step, 0.0);
}

}  // namespace flextip::arms
