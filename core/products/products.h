// Large matrix products. Where the processor has AVX2 they are two to four times as quick as
// Eigen's own, which is compiled for any processor. Small products are better left to Eigen.
#pragma once

#include <Eigen/Dense>

namespace flextip {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MatrixView = Eigen::Ref<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
using RowMajorView = Eigen::Ref<const RowMajorMatrix, 0, Eigen::OuterStride<>>;

/// Adds A B to C: A is N x K, B is K x M, C is N x M.
void AddProduct(const MatrixView& A, const MatrixView& B, Eigen::MatrixXd& C);

/// Adds A^T B to C: A is K x N, B is K x M, C is N x M.
void AddTransposedProduct(const MatrixView& A, const MatrixView& B, Eigen::MatrixXd& C);

/// Adds the upper triangle of X^T X to C: X is K x N, C is N x N.
void AddSquares(const RowMajorView& X, Eigen::MatrixXd& C);

}  // namespace flextip
