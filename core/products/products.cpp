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

void AddProduct(const MatrixView& A, const MatrixView& B, Eigen::MatrixXd& C) {
  FLEXTIP_CHECK(A.cols() == B.rows() && C.rows() == A.rows() && C.cols() == B.cols(),
                "shapes of a product");
  products::ForThisProcessor().product(
      {C.rows(), C.cols(), A.cols(), A.outerStride(), B.outerStride(), C.outerStride()}, A.data(),
      B.data(), C.data());
}

void AddTransposedProduct(const MatrixView& A, const MatrixView& B, Eigen::MatrixXd& C) {
  FLEXTIP_CHECK(A.rows() == B.rows() && C.rows() == A.cols() && C.cols() == B.cols(),
                "shapes of a product");
  products::ForThisProcessor().transposed(
      {C.rows(), C.cols(), A.rows(), A.outerStride(), B.outerStride(), C.outerStride()}, A.data(),
      B.data(), C.data());
}

void AddSquares(const RowMajorView& X, Eigen::MatrixXd& C) {
  FLEXTIP_CHECK(C.rows() == X.cols() && C.cols() == X.cols(), "shapes of a product");
  products::ForThisProcessor().squares(
      {C.rows(), C.cols(), X.rows(), X.outerStride(), X.outerStride(), C.outerStride()}, X.data(),
      C.data());
}

}  // namespace flextip
