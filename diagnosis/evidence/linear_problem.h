// The replay's residuals as a linear problem in all parameters and in the generic terms,
// compressed to its normal matrix block of time by block of time: from there every hypothesis is
// weighed without touching a sample again.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "diagnosis/evidence/normal_sums.h"
#include "diagnosis/replay/replay.h"

namespace flextip::diagnosis {

/// Unknowns: the layout's parameters (zero is the base simulation), then one generic coefficient
/// for each measured row and basis function, in standard deviations of that row's noise.
struct LinearProblem {
  int parameters = 0;
  std::vector<int> generic_row;    ///< of each generic unknown: the measured row
  std::vector<NormalSums> blocks;  ///< consecutive stretches of time
  NormalSums total;
  NormalSums known;  ///< what other recordings say of the same unknowns, in `total`; empty: nothing
  /// Root mean square over the samples of what force and wrist noise leave of the residual as it
  /// stands, per measured row in its standard deviations.
  Rows residual_size = Rows::Zero();

  int Size() const { return parameters + int(generic_row.size()); }
  /// Adds what other recordings say, to the total and to all that is made of parts.
  void Know(const NormalSums& others);
  /// Lets `samples` of them count as one: all sums are divided by it.
  void CountAsOne(double samples);
};

/// `basis` has one row a sample (generic_basis.h); empty: no generic terms.
LinearProblem MakeLinearProblem(const Replay& replay, const Eigen::MatrixXd& basis, int blocks);

}  // namespace flextip::diagnosis
