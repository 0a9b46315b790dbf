#include "diagnosis/running/information.h"

#include "core/linear_algebra.h"

namespace flextip::diagnosis::running {

void GrowingBlock::Add(const WatchedRows& rows) {
  H_.noalias() += rows.X.transpose() * rows.X;
  g_.noalias() += rows.X.transpose() * rows.e;
  ++samples_;
}

void GrowingBlock::Close(Information& closed) {
  using Wandering = Eigen::Matrix<double, kWandering, kWandering>;
  const Llt<kWandering> factor(Wandering(H_.bottomRightCorner<kWandering, kWandering>()) +
                               Wandering::Identity());
  const Eigen::Matrix<double, kWandering, kParameters> across =
      factor.SolveL(H_.bottomLeftCorner<kWandering, kParameters>());
  const Eigen::Matrix<double, kWandering, 1> g = factor.SolveL(g_.tail<kWandering>());
  closed.H = H_.topLeftCorner<kParameters, kParameters>();
  closed.H.noalias() -= across.transpose() * across;
  closed.g = g_.head<kParameters>();
  closed.g.noalias() -= across.transpose() * g;
  H_.setZero();
  g_.setZero();
  samples_ = 0;
}

}  // namespace flextip::diagnosis::running
