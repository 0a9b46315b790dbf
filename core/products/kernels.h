// The products on plain arrays, by column; strides are those between columns (rows of X).
// Private to products.cpp, and compiled twice: wide.cpp is for processors with AVX2.
#pragma once

namespace flextip::products {

struct Shape {
  long n, m, k;  ///< C is n x m, the sum is over k
  long a_stride, b_stride, c_stride;
};

struct Kernels {
  void (*product)(const Shape&, const double* A, const double* B, double* C);
  void (*transposed)(const Shape&, const double* A, const double* B, double* C);
  void (*squares)(const Shape&, const double* X, double* C);
};

/// Kernels for any processor, and for one with AVX2 and fused multiply-add.
Kernels Narrow();
Kernels Wide();

}  // namespace flextip::products
