// Squares in stated noise, whatever the noise was measured to be.
#pragma once

#include <Eigen/Dense>

#include "arms/replay/replay.h"
#include "arms/search/noise.h"

namespace flextip::arms {

/// Squares of what is left of all measurements that count, with the parameters moved by `step` as
/// the derivatives say.
double SquaresAfter(const Replay& replay, const Noise& noise, const Eigen::VectorXd& step);

/// Squares of what the step moves.
double SquaresOf(const Replay& replay, const Noise& noise, const Eigen::VectorXd& step);

}  // namespace flextip::arms
