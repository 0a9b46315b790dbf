// The kernels by Eigen, for the instructions that the including file is compiled for.
#include <Eigen/Cholesky>
#include <algorithm>

#include "core/products/kernels.h"

namespace flextip::products {
namespace {

using Stride = Eigen::OuterStride<>;
using Columns = Eigen::Map<Eigen::MatrixXd, 0, Stride>;
using ConstColumns = Eigen::Map<const Eigen::MatrixXd, 0, Stride>;

void Product(const Shape& s, const double* A, const double* B, double* C) {
  Columns(C, s.n, s.m, Stride(s.c_stride)).noalias() +=
      ConstColumns(A, s.n, s.k, Stride(s.a_stride)) * ConstColumns(B, s.k, s.m, Stride(s.b_stride));
}

void Transposed(const Shape& s, const double* A, const double* B, double* C) {
  Columns(C, s.n, s.m, Stride(s.c_stride)).noalias() +=
      ConstColumns(A, s.k, s.n, Stride(s.a_stride)).transpose() *
      ConstColumns(B, s.k, s.m, Stride(s.b_stride));
}

/// Rows of X are columns of its transpose.
void Squares(const Shape& s, const double* X, double* C) {
  Columns(C, s.n, s.n, Stride(s.c_stride))
      .selfadjointView<Eigen::Upper>()
      .rankUpdate(ConstColumns(X, s.n, s.k, Stride(s.a_stride)));
}

bool Cholesky(long n, double* A) {
  Eigen::Map<Eigen::MatrixXd> matrix(A, n, n);
  Eigen::Ref<Eigen::MatrixXd> in_place(matrix);
  return Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(in_place).info() == Eigen::Success;
}

void SolveLower(long n, long m, const double* L, double* B) {
  Eigen::Map<Eigen::MatrixXd> x(B, n, m);
  Eigen::Map<const Eigen::MatrixXd>(L, n, n).triangularView<Eigen::Lower>().solveInPlace(x);
}

void SolveTransposed(long n, long m, const double* L, double* B) {
  Eigen::Map<Eigen::MatrixXd> x(B, n, m);
  Eigen::Map<const Eigen::MatrixXd>(L, n, n)
      .transpose()
      .triangularView<Eigen::Upper>()
      .solveInPlace(x);
}

/// By blocks of columns, below the diagonal alone: two thirds of n^3 operations in place of two n^3
/// by all columns of the identity.
void Inverse(long n, const double* L, double* to) {
  constexpr long kBlock = 32;
  const Eigen::Map<const Eigen::MatrixXd> lower(L, n, n);
  Eigen::Map<Eigen::MatrixXd> inverse(to, n, n);
  Eigen::MatrixXd W = Eigen::MatrixXd::Identity(n, n);  // to be L^-1
  for (long j = 0; j < n; j += kBlock) {
    auto columns = W.block(j, j, n - j, std::min(kBlock, n - j));
    lower.bottomRightCorner(n - j, n - j).triangularView<Eigen::Lower>().solveInPlace(columns);
  }
  for (long j = 0; j < n; j += kBlock) {
    const long size = std::min(kBlock, n - j);
    inverse.block(j, j, n - j, size).noalias() =
        W.bottomRightCorner(n - j, n - j).transpose().triangularView<Eigen::Upper>() *
        W.block(j, j, n - j, size);
    inverse.block(j, j + size, size, n - j - size) =
        inverse.block(j + size, j, n - j - size, size).transpose();
  }
}

constexpr Kernels kKernels{Product,    Transposed,      Squares, Cholesky,
                           SolveLower, SolveTransposed, Inverse};

}  // namespace
}  // namespace flextip::products
