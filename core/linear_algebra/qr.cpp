#include "core/linear_algebra.h"

namespace flextip {

CompleteOrthogonal::CompleteOrthogonal(const Eigen::MatrixXd& A, double threshold) {
  if (threshold > 0.0) qr_.setThreshold(threshold);
  qr_.compute(A);
}

Eigen::VectorXd CompleteOrthogonal::Solve(const Eigen::VectorXd& b) const { return qr_.solve(b); }

Eigen::MatrixXd CompleteOrthogonal::PseudoInverse() const { return qr_.pseudoInverse(); }

Eigen::VectorXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.colPivHouseholderQr().solve(b);
}

}  // namespace flextip
