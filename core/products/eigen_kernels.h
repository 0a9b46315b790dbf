// The kernels by Eigen, for the instructions that the including file is compiled for.
#include <Eigen/Core>

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

}  // namespace
}  // namespace flextip::products
