#include "core/linear_algebra.h"

namespace flextip {

template <int N>
CompleteOrthogonal<N>::CompleteOrthogonal(const Matrix& A, double threshold) {
  if (threshold > 0.0) qr_.setThreshold(threshold);
  qr_.compute(A);
}

template <int N>
auto CompleteOrthogonal<N>::Solve(const Vector& b) const -> Vector {
  return qr_.solve(b);
}

template <int N>
auto CompleteOrthogonal<N>::PseudoInverse() const -> Matrix {
  return qr_.pseudoInverse();
}

template class CompleteOrthogonal<6>;
template class CompleteOrthogonal<Eigen::Dynamic>;

Eigen::VectorXd LeastSquares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.colPivHouseholderQr().solve(b);
}

}  // namespace flextip
