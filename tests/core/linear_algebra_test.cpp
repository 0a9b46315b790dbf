// The decompositions against their definitions, for every size that is compiled on its own and for
// one that is taken as dynamic.
#include "core/linear_algebra.h"

#include <gtest/gtest.h>

namespace flextip {
namespace {

template <int N>
using Square = Eigen::Matrix<double, N, N>;

template <class N>
class LinearAlgebra : public testing::Test {
 protected:
  void SetUp() override {
    std::srand(5);
    A = Square<N::value>::Random();
    positive = A * A.transpose() + 0.1 * Square<N::value>::Identity();
    b = b.Random();
  }

  Square<N::value> A, positive, I = Square<N::value>::Identity();
  Eigen::Matrix<double, N::value, 4> b;
};

using Sizes = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>,
                             std::integral_constant<int, 6>, std::integral_constant<int, 9>,
                             std::integral_constant<int, 5>>;
TYPED_TEST_SUITE(LinearAlgebra, Sizes);

TYPED_TEST(LinearAlgebra, Ldlt) {
  const Ldlt ldlt(this->positive);
  EXPECT_TRUE(ldlt.Succeeded());
  EXPECT_TRUE(ldlt.IsPositive());
  EXPECT_GT(ldlt.Pivots().minCoeff(), 0.0);
  EXPECT_LT((this->positive * ldlt.Solve(this->b) - this->b).norm(), 1e-12);
  EXPECT_LT((this->positive * ldlt.Inverse() - this->I).norm(), 1e-12);
  EXPECT_FALSE(Ldlt(this->A + this->A.transpose() - 3.0 * this->I).IsPositive());
}

TYPED_TEST(LinearAlgebra, Llt) {
  const Llt llt(this->positive);
  EXPECT_TRUE(llt.Succeeded());
  EXPECT_LT((llt.L() * llt.L().transpose() - this->positive).norm(), 1e-13);
  EXPECT_LT((this->positive * llt.Solve(this->b) - this->b).norm(), 1e-12);
  EXPECT_LT((llt.L() * llt.SolveL(this->b) - this->b).norm(), 1e-12);
  EXPECT_LT((llt.L().transpose() * llt.SolveLTransposed(this->b) - this->b).norm(), 1e-12);
  EXPECT_LT((this->positive * llt.Inverse() - this->I).norm(), 1e-12);
  EXPECT_NEAR(llt.LogDeterminant(), std::log(this->positive.determinant()), 1e-12);
  EXPECT_FALSE(Llt(this->A + this->A.transpose() - 3.0 * this->I).Succeeded());
}

TEST(LargeLlt, TheInverseOfSeveralBlocksIsOne) {
  for (const int n : {1, 31, 32, 33, 100}) {
    const Eigen::MatrixXd B = Eigen::MatrixXd::NullaryExpr(
        n, n,
        [](Eigen::Index i, Eigen::Index j) { return std::sin(7.0 * double(i * j) + double(i)); });
    const Eigen::MatrixXd A = B * B.transpose() + Eigen::MatrixXd::Identity(n, n);
    const Eigen::MatrixXd inverse = Llt(A).Inverse();
    EXPECT_LT((A * inverse - Eigen::MatrixXd::Identity(n, n)).norm(), 1e-10) << n;
    EXPECT_EQ((inverse - inverse.transpose()).norm(), 0.0) << n;
  }
}

TYPED_TEST(LinearAlgebra, Lu) {
  const Lu lu(this->A);
  EXPECT_LT((this->A * lu.Solve(this->b) - this->b).norm(), 1e-12);
  EXPECT_LT((this->A * lu.Inverse() - this->I).norm(), 1e-12);
}

TYPED_TEST(LinearAlgebra, SymmetricEigen) {
  const SymmetricEigen eigen(this->positive);
  EXPECT_LT((this->positive * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()).norm(),
            1e-13);
  EXPECT_LT((eigen.vectors.transpose() * eigen.vectors - this->I).norm(), 1e-13);
  EXPECT_LT((SymmetricEigenvalues(this->positive) - eigen.values).norm(), 1e-13);
  for (int i = 1; i < eigen.values.size(); ++i) EXPECT_LE(eigen.values[i - 1], eigen.values[i]);
}

TYPED_TEST(LinearAlgebra, MahalanobisDistance) {
  const auto e = this->b.col(0);
  EXPECT_NEAR(MahalanobisSquared(e, this->positive), e.dot(this->positive.inverse() * e), 1e-11);
}

TEST(LinearAlgebraOfOneSize, Svd) {
  const Eigen::Matrix3d A{{1, 2, 3}, {-2, 0.5, 1}, {4, -1, 0.2}};
  const Svd svd(A);
  EXPECT_LT((svd.U * svd.sigma.asDiagonal() * svd.V.transpose() - A).norm(), 1e-14);
  EXPECT_LT((svd.U.transpose() * svd.U - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_LT((SingularValues(A) - svd.sigma).norm(), 1e-14);
  EXPECT_GE(svd.sigma[0], svd.sigma[1]);
  EXPECT_GE(svd.sigma[1], svd.sigma[2]);
}

TEST(LinearAlgebraOfOneSize, FullLuTellsTheRank) {
  const Eigen::Matrix2d A{{1, 2}, {3, 4}}, singular{{1, 2}, {2, 4}};
  EXPECT_TRUE(FullLu(A).IsInvertible());
  EXPECT_FALSE(FullLu(singular).IsInvertible());
  EXPECT_LT((A * FullLu(A).Solve(Eigen::Vector2d(1, -1)) - Eigen::Vector2d(1, -1)).norm(), 1e-14);
}

TEST(LinearAlgebraOfOneSize, ConditionOfADiagonalMatrix) {
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Identity();
  A(0, 0) = 1e-5;
  EXPECT_NEAR(Ldlt(A).ReciprocalCondition(), 1e-5, 1e-9);
  EXPECT_NEAR(Llt(Eigen::MatrixXd(A)).ReciprocalCondition(), 1e-5, 1e-9);
}

TEST(LinearAlgebraOfOneSize, LeastSquares) {
  const Eigen::MatrixXd A{{1, 0}, {1, 1}, {1, 2}};
  const Eigen::VectorXd x = LeastSquares(A, Eigen::Vector3d(1, 2, 6));
  EXPECT_NEAR(x[0], 0.5, 1e-14);  // by hand from the normal equations
  EXPECT_NEAR(x[1], 2.5, 1e-14);
}

TEST(LinearAlgebraOfOneSize, LeastNorm) {
  const Eigen::MatrixXd A{{1, 1}, {0, 1e-9}};
  const CompleteOrthogonal decomposition(A, 1e-6);
  const Eigen::VectorXd x = decomposition.Solve(Eigen::Vector2d(2, 0));
  EXPECT_LT((x - Eigen::Vector2d(1, 1)).norm(), 1e-8);
  EXPECT_LT((decomposition.PseudoInverse() * Eigen::Vector2d(2, 0) - x).norm(), 1e-8);
}

}  // namespace
}  // namespace flextip
