#include "core/linear_algebra.h"
#include "core/linear_algebra/columns.h"
#include "core/products/kernels.h"

namespace flextip {

LargeLlt::LargeLlt(const Eigen::MatrixXd& A) : L_(A) {
  if (!products::ForThisProcessor().cholesky(L_.rows(), L_.data())) info_ = Eigen::NumericalIssue;
}

template <int N>
Llt<N>::Llt(const std::type_identity_t<Matrix>& A) : llt_(A) {}

template <int N>
void Llt<N>::SolveInPlace(double* columns, Eigen::Index count) const {
  SolveLInPlace(columns, count);
  SolveLTransposedInPlace(columns, count);
}

template <int N>
void Llt<N>::SolveLInPlace(double* columns, Eigen::Index count) const {
  if constexpr (N == Eigen::Dynamic) {
    products::ForThisProcessor().solve_lower(llt_.rows(), count, llt_.matrixLLT().data(), columns);
  } else {
    ForColumns<N>(columns, N, count, [&](auto& x) { llt_.matrixL().solveInPlace(x); });
  }
}

template <int N>
void Llt<N>::SolveLTransposedInPlace(double* columns, Eigen::Index count) const {
  if constexpr (N == Eigen::Dynamic) {
    products::ForThisProcessor().solve_transposed(llt_.rows(), count, llt_.matrixLLT().data(),
                                                  columns);
  } else {
    ForColumns<N>(columns, N, count, [&](auto& x) { llt_.matrixU().solveInPlace(x); });
  }
}

template <int N>
auto Llt<N>::Inverse() const -> Matrix {
  const Eigen::Index n = llt_.rows();
  if constexpr (N == Eigen::Dynamic) {
    Matrix inverse(n, n);
    products::ForThisProcessor().inverse(n, llt_.matrixLLT().data(), inverse.data());
    return inverse;
  } else {
    Matrix inverse = Matrix::Identity();
    SolveInPlace(inverse.data(), n);
    return inverse;
  }
}

template <int N>
auto Llt<N>::L() const -> Matrix {
  return llt_.matrixLLT().template triangularView<Eigen::Lower>();
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
  const auto norm = [](const Matrix& A) { return A.cwiseAbs().colwise().sum().maxCoeff(); };
  const Matrix lower = L();
  return 1.0 / (norm(lower * lower.transpose()) * norm(Inverse()));
}

template class Llt<2>;
template class Llt<3>;
template class Llt<6>;
template class Llt<21>;  // the running diagnosis: a sample, all parameters
template class Llt<48>;
template class Llt<Eigen::Dynamic>;

}  // namespace flextip
