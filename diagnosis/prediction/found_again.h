// What a recording has of its own, found again where a model of another recording predicts it.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {

/// Moves `replay` to the parameters `theta`, of which it finds anew: nuisances (registration, the
/// mean of unknown forces), and of the blocks `present` the states (where a play stood) and phases.
/// All other parameters stay. False where more than a tenth of the samples have no equilibrium.
bool FindAgain(Replay& replay, const Eigen::VectorXd& theta, const std::vector<int>& present);

}  // namespace flextip::diagnosis
