#include "core/linear_algebra.h"

namespace flextip {

template <int N>
SymmetricEigen<N>::SymmetricEigen(const std::type_identity_t<Matrix>& A) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(A);
  values = solver.eigenvalues();
  vectors = solver.eigenvectors();
}

template <int N>
auto SymmetricEigen<N>::Values(const Matrix& A) -> Vector {
  return Eigen::SelfAdjointEigenSolver<Matrix>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

template struct SymmetricEigen<2>;
template struct SymmetricEigen<3>;
template struct SymmetricEigen<6>;
template struct SymmetricEigen<Eigen::Dynamic>;

}  // namespace flextip
