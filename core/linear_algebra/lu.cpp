#include "core/linear_algebra.h"
#include "core/linear_algebra/columns.h"

namespace flextip {

template <int N>
Lu<N>::Lu(const std::type_identity_t<Matrix>& A) : lu_(A) {}

template <int N>
void Lu<N>::SolveInPlace(double* columns, Eigen::Index count) const {
  ForColumns<N>(columns, lu_.rows(), count, [&](auto& x) {
    x = lu_.permutationP() * x;
    lu_.matrixLU().template triangularView<Eigen::UnitLower>().solveInPlace(x);
    lu_.matrixLU().template triangularView<Eigen::Upper>().solveInPlace(x);
  });
}

template <int N>
auto Lu<N>::Inverse() const -> Matrix {
  Matrix inverse = Matrix::Identity(lu_.rows(), lu_.cols());
  SolveInPlace(inverse.data(), inverse.cols());
  return inverse;
}

template <int N>
FullLu<N>::FullLu(const std::type_identity_t<Matrix>& A) : lu_(A) {}

template <int N>
auto FullLu<N>::Solve(const Vector& b) const -> Vector {
  return lu_.solve(b);
}

template <int N>
bool FullLu<N>::IsInvertible() const {
  return lu_.isInvertible();
}

template class Lu<2>;
template class Lu<3>;
template class Lu<6>;
template class Lu<Eigen::Dynamic>;

template class FullLu<2>;
template class FullLu<Eigen::Dynamic>;

}  // namespace flextip
