// How long what the best answer leaves of the measurements stays the same: slow residuals are fewer
// independent measurements than there are samples.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

namespace flextip::diagnosis {

class Replay;
struct LinearProblem;

struct ResidualMemory {
  std::string channel;       ///< of the row with the largest slow part; empty: none can be told
  double correlation = 0.0;  ///< of that row's residuals, from sample to sample
  /// The variance of their slow part over the variance taken: of a mean of n residuals n times the
  /// variance, where that of one is 1.
  double slow_variance = 0.0;

  /// Returns how many samples tell as much as one that is independent of the others: at least 1.
  double SamplesAsOne() const { return slow_variance > 1.0 ? slow_variance : 1.0; }
};

/// Returns the memory of the residuals that the unknowns `x` (parameters, then generic terms) of
/// `problem` leave, row by row as an AR(1) process: mean square times (1 + rho)/(1 - rho).
/// `problem` was made of `replay` and `basis` as they are. What chance explains counts as none.
ResidualMemory MemoryOfResiduals(const Replay& replay, const Eigen::MatrixXd& basis,
                                 const LinearProblem& problem, const Eigen::VectorXd& x);

/// Returns the memory of residuals in order of time. `channel` stays empty.
ResidualMemory MemoryOfSeries(const std::vector<double>& residuals);

}  // namespace flextip::diagnosis
