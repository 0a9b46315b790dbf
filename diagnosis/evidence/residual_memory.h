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
  std::string channel;       ///< the one that remembers most; empty: none does
  double correlation = 0.0;  ///< of its residuals, from sample to sample
  /// The variance of the residuals' slow part over the variance taken: so many samples tell as much
  /// as one that is independent of the others. At least 1.
  double samples_as_one = 1.0;
};

/// Returns the memory of the residuals that the unknowns `x` (parameters, then generic terms) of
/// `problem` leave, channel by channel as an AR(1) process: mean square times (1 + rho)/(1 - rho).
/// `problem` was made of `replay` and `basis` as they are. Correlations and mean squares that
/// chance explains count as none.
ResidualMemory MemoryOfResiduals(const Replay& replay, const Eigen::MatrixXd& basis,
                                 const LinearProblem& problem, const Eigen::VectorXd& x);

/// Returns the memory of a single series of residuals of unit variance, `values` in order of time,
/// pooled over rows: each inner vector is a row's. `channel` stays empty.
ResidualMemory MemoryOfSeries(const std::vector<std::vector<double>>& rows);

}  // namespace flextip::diagnosis
