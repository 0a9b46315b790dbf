// Solving for all columns of a right-hand side, for the decompositions of this folder.
#pragma once

#include <Eigen/Dense>

namespace flextip {

/// Calls `solve(x)` with a map of the right-hand side: by single columns where N is fixed (Eigen
/// unrolls these), at once where it is dynamic (Eigen then works by blocks).
template <int N, class F>
void ForColumns(double* columns, Eigen::Index rows, Eigen::Index count, const F& solve) {
  if constexpr (N == Eigen::Dynamic) {
    if (count != 1) {
      Eigen::Map<Eigen::MatrixXd> x(columns, rows, count);
      solve(x);
      return;
    }
  }
  for (Eigen::Index j = 0; j < count; ++j) {
    Eigen::Map<Eigen::Matrix<double, N, 1>> x(columns + j * rows, rows);
    solve(x);
  }
}

}  // namespace flextip
