// Smooth functions of what a person would plot a residual against: what an effect outside the
// catalogue may look like, and what the catalogue's own forms may miss of a real effect.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {

/// What residuals are held against. Each has one value a sample.
struct Regressor {
  std::string name;
  Eigen::VectorXd value;  ///< in its own unit
};

/// Insertion depth, direction, sliding and wrist speed, load, time: of the last replay. An unknown
/// force is that of the samples around.
std::vector<Regressor> Regressors(const Replay& replay);

/// Columns are functions of the regressors (powers, signs, waves in time), one row a sample,
/// orthogonal to each other with mean square one.
Eigen::MatrixXd GenericBasis(const Replay& replay);

}  // namespace flextip::diagnosis
