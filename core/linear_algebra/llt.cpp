#include <algorithm>

#include "core/linear_algebra.h"
#include "core/linear_algebra/columns.h"

namespace flextip {

template <int N>
Llt<N>::Llt(const std::type_identity_t<Matrix>& A) : llt_(A) {}

template <int N>
void Llt<N>::SolveInPlace(double* columns, Eigen::Index count) const {
  SolveLInPlace(columns, count);
  SolveLTransposedInPlace(columns, count);
}

template <int N>
void Llt<N>::SolveLInPlace(double* columns, Eigen::Index count) const {
  ForColumns<N>(columns, llt_.rows(), count, [&](auto& x) { llt_.matrixL().solveInPlace(x); });
}

template <int N>
void Llt<N>::SolveLTransposedInPlace(double* columns, Eigen::Index count) const {
  ForColumns<N>(columns, llt_.rows(), count, [&](auto& x) { llt_.matrixU().solveInPlace(x); });
}

namespace {

/// Returns A^-1 for A = L L^T by blocks of columns, below the diagonal alone: two thirds of n^3
/// operations in place of two n^3 by all columns of the identity.
Eigen::MatrixXd InverseByBlocks(const Eigen::MatrixXd& L) {
  constexpr Eigen::Index kBlock = 32;
  const Eigen::Index n = L.rows();
  Eigen::MatrixXd W = Eigen::MatrixXd::Identity(n, n);  // to be L^-1
  for (Eigen::Index j = 0; j < n; j += kBlock) {
    auto columns = W.block(j, j, n - j, std::min(kBlock, n - j));
    L.bottomRightCorner(n - j, n - j).triangularView<Eigen::Lower>().solveInPlace(columns);
  }
  Eigen::MatrixXd inverse(n, n);
  for (Eigen::Index j = 0; j < n; j += kBlock) {
    const Eigen::Index size = std::min(kBlock, n - j);
    inverse.block(j, j, n - j, size).noalias() =
        W.bottomRightCorner(n - j, n - j).transpose().triangularView<Eigen::Upper>() *
        W.block(j, j, n - j, size);
    inverse.block(j, j + size, size, n - j - size) =
        inverse.block(j + size, j, n - j - size, size).transpose();
  }
  return inverse;
}

}  // namespace

template <int N>
auto Llt<N>::Inverse() const -> Matrix {
  if constexpr (N == Eigen::Dynamic) return InverseByBlocks(llt_.matrixLLT());
  Matrix inverse = Matrix::Identity(llt_.rows(), llt_.cols());
  SolveInPlace(inverse.data(), inverse.cols());
  return inverse;
}

template <int N>
auto Llt<N>::L() const -> Matrix {
  return llt_.matrixL();
}

template <int N>
double Llt<N>::LogDeterminant() const {
  return 2.0 * llt_.matrixLLT().diagonal().array().log().sum();
}

template <int N>
bool Llt<N>::Succeeded() const {
  return llt_.info() == Eigen::Success;
}

template <int N>
double Llt<N>::ReciprocalCondition() const requires(N == Eigen::Dynamic) {
  return llt_.rcond();
}

template class Llt<2>;
template class Llt<3>;
template class Llt<6>;
template class Llt<21>;  // the running diagnosis: a sample, all parameters
template class Llt<48>;
template class Llt<Eigen::Dynamic>;

}  // namespace flextip
