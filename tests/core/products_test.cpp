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

TEST(Products, AreTheSameForAnyProcessor) {
  std::mt19937_64 rng(75);
  const Eigen::MatrixXd A = Random(kN, kK, rng), B = Random(kK, kM, rng);
  const RowMajorMatrix X = Random(kK, kN, rng);
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(kN, kM), narrow = product;
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(kN, kN), narrow_squares = squares;
  AddProduct(A, B, product);
  AddSquares(X, squares);
  const products::Kernels any = products::Narrow();
  any.product({kN, kM, kK, kN, kK, kN}, A.data(), B.data(), narrow.data());
  any.squares({kN, kN, kK, kN, kN, kN}, X.data(), narrow_squares.data());
  EXPECT_LT((product - narrow).norm(), 1e-11);
  EXPECT_LT((squares - narrow_squares).norm(), 1e-11);
  EXPECT_GT(narrow.norm(), 1.0);
}

}  // namespace
}  // namespace flextip
