#include "core/linear_algebra.h"
#include "core/linear_algebra/columns.h"
#include "core/products/kernels.h"

namespace flextip {

LargeLlt::LargeLlt(const Eigen::MatrixXd& A) : factor_(A) {
  succeeded_ = products::ForThisProcessor().cholesky(Size(), factor_.data());
}

namespace {

const Eigen::MatrixXd& FactorOf(const LargeLlt& llt) { return llt.Factor(); }
template <class Matrix>
const Matrix& FactorOf(const Eigen::LLT<Matrix>& llt) {
  return llt.matrixLLT();
}

}  // namespace

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
    products::ForThisProcessor().solve_lower(llt_.Size(), count, llt_.Factor().data(), columns);
  } else {
    ForColumns<N>(columns, N, count, [&](auto& x) { llt_.matrixL().solveInPlace(x); });
  }
}

template <int N>
void Llt<N>::SolveLTransposedInPlace(double* columns, Eigen::Index count) const {
  if constexpr (N == Eigen::Dynamic) {
    products::ForThisProcessor().solve_transposed(llt_.Size(), count, llt_.Factor().data(),
                                                  columns);
  } else {
    ForColumns<N>(columns, N, count, [&](auto& x) { llt_.matrixU().solveInPlace(x); });
  }
}

template <int N>
auto Llt<N>::Inverse() const -> Matrix {
  if constexpr (N == Eigen::Dynamic) {
    Matrix inverse(llt_.Size(), llt_.Size());
    products::ForThisProcessor().inverse(llt_.Size(), llt_.Factor().data(), inverse.data());
    return inverse;
  } else {
    Matrix inverse = Matrix::Identity();
    SolveInPlace(inverse.data(), N);
    return inverse;
  }
}

template <int N>
auto Llt<N>::L() const -> Matrix {
  return FactorOf(llt_).template triangularView<Eigen::Lower>();
}

template <int N>
double Llt<N>::LogDeterminant() const {
  return 2.0 * FactorOf(llt_).diagonal().array().log().sum();
}

template <int N>
bool Llt<N>::Succeeded() const {
  if constexpr (N == Eigen::Dynamic)
    return llt_.Succeeded();
  else
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
