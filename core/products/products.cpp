#include "core/products/products.h"

#include "core/check.h"
#include "core/products/eigen_kernels.h"

namespace flextip {
namespace products {

Kernels Narrow() { return kKernels; }

const Kernels& ForThisProcessor() {
#ifdef FLEXTIP_HAS_WIDE_PRODUCTS
  static const Kernels kernels =
      __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0 ? Wide() : Narrow();
#else
  static const Kernels kernels = Narrow();
#endif
  return kernels;
}

}  // namespace products

namespace {

using OfTwo = void (*)(const products::Shape&, const double*, const double*, double*);

/// `sum` is over so many rows or columns of A, which must be B's rows.
void Add(OfTwo kernel, const MatrixView& A, const MatrixView& B, Eigen::Index rows,
         Eigen::Index sum, Eigen::MatrixXd& C) {
  FLEXTIP_CHECK(sum == B.rows() && C.rows() == rows && C.cols() == B.cols(), "shapes of a product");
  kernel({C.rows(), C.cols(), sum, A.outerStride(), B.outerStride(), C.outerStride()}, A.data(),
         B.data(), C.data());
}

}  // namespace

void AddProduct(const MatrixView& A, const MatrixView& B, Eigen::MatrixXd& C) {
  Add(products::ForThisProcessor().product, A, B, A.rows(), A.cols(), C);
}

void AddTransposedProduct(const MatrixView& A, const MatrixView& B, Eigen::MatrixXd& C) {
  Add(products::ForThisProcessor().transposed, A, B, A.cols(), A.rows(), C);
}

void AddSquares(const RowMajorView& X, Eigen::MatrixXd& C) {
  FLEXTIP_CHECK(C.rows() == X.cols() && C.cols() == X.cols(), "shapes of a product");
  products::ForThisProcessor().squares(
      {C.rows(), C.cols(), X.rows(), X.outerStride(), X.outerStride(), C.outerStride()}, X.data(),
      C.data());
}

}  // namespace flextip
