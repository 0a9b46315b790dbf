// Large products against sums entry by entry, by the kernels for this processor and for any.
#include "core/products/products.h"

#include <gtest/gtest.h>

#include <random>

#include "core/products/kernels.h"

namespace flextip {
namespace {

Eigen::MatrixXd Random(Eigen::Index rows, Eigen::Index cols, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal(rng); });
}

/// C + A B, entry by entry.
Eigen::MatrixXd Sums(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, Eigen::MatrixXd C) {
  for (Eigen::Index i = 0; i < C.rows(); ++i)
    for (Eigen::Index j = 0; j < C.cols(); ++j)
      for (Eigen::Index k = 0; k < A.cols(); ++k) C(i, j) += A(i, k) * B(k, j);
  return C;
}

constexpr Eigen::Index kN = 37, kM = 23, kK = 91;

TEST(Products, OfPartsOfMatricesAreTheSums) {
  std::mt19937_64 rng(72);
  const Eigen::MatrixXd A = Random(kN + 5, kK + 2, rng), B = Random(kK + 3, kM + 1, rng);
  const Eigen::MatrixXd before = Random(kN, kM, rng);
  Eigen::MatrixXd C = before;
  AddProduct(A.block(2, 1, kN, kK), B.block(3, 1, kK, kM), C);
  EXPECT_LT((C - Sums(A.block(2, 1, kN, kK), B.block(3, 1, kK, kM), before)).norm(), 1e-11);
}

TEST(Products, OfATransposeAreTheSums) {
  std::mt19937_64 rng(73);
  const Eigen::MatrixXd A = Random(kK, kN, rng), B = Random(kK, kM, rng);
  const Eigen::MatrixXd before = Random(kN, kM, rng);
  Eigen::MatrixXd C = before;
  AddTransposedProduct(A, B, C);
  EXPECT_LT((C - Sums(A.transpose(), B, before)).norm(), 1e-11);
}

TEST(Products, SquaresFillTheUpperTriangleOnly) {
  std::mt19937_64 rng(74);
  const RowMajorMatrix X = Random(kK + 4, kN, rng);
  const Eigen::MatrixXd part = X.middleRows(4, kK), before = Random(kN, kN, rng);
  Eigen::MatrixXd C = before;
  AddSquares(X.middleRows(4, kK), C);
  Eigen::MatrixXd expected = Sums(part.transpose(), part, before);
  expected.triangularView<Eigen::StrictlyLower>() = before.triangularView<Eigen::StrictlyLower>();
  EXPECT_LT((C - expected).norm(), 1e-11);
}

/// The kernels that this processor does not use, where it has AVX2.
TEST(Products, OfAnyProcessorAreTheSums) {
  std::mt19937_64 rng(75);
  const Eigen::MatrixXd A = Random(kN, kK, rng), B = Random(kK, kM, rng);
  const Eigen::MatrixXd At = A.transpose();
  const products::Kernels any = products::Narrow();
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(kN, kM), transposed = product;
  any.product({kN, kM, kK, kN, kK, kN}, A.data(), B.data(), product.data());
  any.transposed({kN, kM, kK, kK, kK, kN}, At.data(), B.data(), transposed.data());
  const Eigen::MatrixXd expected = Sums(A, B, Eigen::MatrixXd::Zero(kN, kM));
  EXPECT_LT((product - expected).norm(), 1e-11);
  EXPECT_LT((transposed - expected).norm(), 1e-11);
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(kN, kN);
  any.squares({kN, kN, kK, kN, kN, kN}, A.data(), squares.data());  // columns of A: rows of X
  const Eigen::MatrixXd off = squares - Sums(A, At, Eigen::MatrixXd::Zero(kN, kN));
  EXPECT_LT(Eigen::MatrixXd(off.triangularView<Eigen::Upper>()).norm(), 1e-11);
}

TEST(Products, DecompositionsOfAnyProcessorAreOnes) {
  std::mt19937_64 rng(76);
  const Eigen::MatrixXd root = Random(kN, kK, rng), B = Random(kN, kM, rng);
  const Eigen::MatrixXd A = root * root.transpose(), I = Eigen::MatrixXd::Identity(kN, kN);
  const products::Kernels any = products::Narrow();
  Eigen::MatrixXd factor = A, lower = B, upper = B, inverse(kN, kN);
  ASSERT_TRUE(any.cholesky(kN, factor.data()));
  any.solve_lower(kN, kM, factor.data(), lower.data());
  any.solve_transposed(kN, kM, factor.data(), upper.data());
  any.inverse(kN, factor.data(), inverse.data());
  const Eigen::MatrixXd L = factor.triangularView<Eigen::Lower>();
  EXPECT_LT((L * L.transpose() - A).norm(), 1e-11);
  EXPECT_LT((L * lower - B).norm(), 1e-11);
  EXPECT_LT((L.transpose() * upper - B).norm(), 1e-11);
  EXPECT_LT((A * inverse - I).norm(), 1e-11);
  Eigen::MatrixXd negative = A - 1e3 * I;
  EXPECT_FALSE(any.cholesky(kN, negative.data()));
}

}  // namespace
}  // namespace flextip
