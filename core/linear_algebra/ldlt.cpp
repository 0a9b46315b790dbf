#include "core/linear_algebra.h"
#include "core/linear_algebra/columns.h"

namespace flextip {

template <int N>
Ldlt<N>::Ldlt(const std::type_identity_t<Matrix>& A) : ldlt_(A) {}

template <int N>
void Ldlt<N>::SolveInPlace(double* columns, Eigen::Index count) const {
  ForColumns<N>(columns, ldlt_.rows(), count, [&](auto& x) { x = ldlt_.solve(x); });
}

template <int N>
auto Ldlt<N>::Inverse() const -> Matrix {
  Matrix inverse = Matrix::Identity(ldlt_.rows(), ldlt_.cols());
  SolveInPlace(inverse.data(), inverse.cols());
  return inverse;
}

template <int N>
auto Ldlt<N>::Pivots() const -> Vector {
  return ldlt_.vectorD();
}

template <int N>
bool Ldlt<N>::IsPositive() const {
  return Succeeded() && ldlt_.isPositive();
}

template <int N>
bool Ldlt<N>::Succeeded() const {
  return ldlt_.info() == Eigen::Success;
}

template <int N>
double Ldlt<N>::ReciprocalCondition() const requires(N == 6) {
  return ldlt_.rcond();
}

template class Ldlt<2>;
template class Ldlt<3>;
template class Ldlt<6>;
template class Ldlt<9>;
template class Ldlt<Eigen::Dynamic>;

}  // namespace flextip
