// Kernels on plain arrays, stored by columns; strides are those between columns (rows of X).
// Private to core, and compiled twice: wide.cpp is for processors with AVX2.
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
  /// In place of A (n x n, its lower triangle is read): L L^T = A. False where A is not positive.
  bool (*cholesky)(long n, double* A);
  /// In place of B (n x m): L^-1 B, and L^-T B.
  void (*solve_lower)(long n, long m, const double* L, double* B);
  void (*solve_transposed)(long n, long m, const double* L, double* B);
  /// A^-1 from L.
  void (*inverse)(long n, const double* L, double* inverse);
};

/// Kernels for any processor, and for one with AVX2 and fused multiply-add.
Kernels Narrow();
Kernels Wide();

/// The quicker ones that this processor has.
const Kernels& ForThisProcessor();

}  // namespace flextip::products
