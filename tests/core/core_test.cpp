#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/derivative_check.h"
#include "core/pose.h"
#include "core/rotation.h"
#include "core/time_series.h"

namespace flextip {
namespace {

Eigen::Vector3d RandomVector(std::mt19937_64& rng) {
  std::normal_distribution<double> n;
  return {n(rng), n(rng), n(rng)};
}

TEST(Rotation, ExpAndLogAreInverse) {
  std::mt19937_64 rng(1);
  for (const double size : {0.0, 1e-13, 1e-8, 1e-3, 1.0, 3.0}) {
    const Eigen::Vector3d w = size * RandomVector(rng).normalized();
    EXPECT_LT((LogRotation(ExpRotation(w)) - w).norm(), 1e-12) << size;
  }
}

TEST(Rotation, WithoutTwistTakesOneVectorToTheOther) {
  std::mt19937_64 rng(2);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d a = RandomVector(rng).normalized(), b = RandomVector(rng).normalized();
    const Eigen::Matrix3d R = RotationWithoutTwist(a, b);
    EXPECT_LT((R * a - b).norm(), 1e-12);
    EXPECT_LT(std::abs(LogRotation(R).dot(a)), 1e-12);  // the axis is normal to both: no twist
  }
}

TEST(Rotation, WithoutTwistTakesOppositeDirections) {
  std::mt19937_64 rng(5);
  for (const double off : {0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-3}) {
    for (int i = 0; i < 20; ++i) {
      const Eigen::Vector3d a = RandomVector(rng).normalized();
      const Eigen::Vector3d b = (off * RandomVector(rng) - a).normalized();
      const Eigen::Matrix3d R = RotationWithoutTwist(a, b);
      EXPECT_LT((R * a - b).norm(), 1e-6) << off;
      EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-14) << off;
      EXPECT_GT(R.determinant(), 0.0);
    }
  }
}

TEST(Rotation, NormalBasisIsRightHanded) {
  std::mt19937_64 rng(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d t = RandomVector(rng).normalized();
    Eigen::Matrix3d R;
    R << t, NormalBasis(t);
    EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_GT(R.determinant(), 0.0);
  }
}

TEST(Pose, InverseAndProductAgreeWithMatrices) {
  std::mt19937_64 rng(4);
  const Pose A{ExpRotation(RandomVector(rng)), RandomVector(rng)};
  const Pose B{ExpRotation(RandomVector(rng)), RandomVector(rng)};
  EXPECT_LT(((A * B).Matrix() - A.Matrix() * B.Matrix()).norm(), 1e-14);
  EXPECT_LT((A.Inverse().Matrix() - A.Matrix().inverse()).norm(), 1e-14);
}

TEST(TimeSeries, InterpolatesInsideAndNothingOutside) {
  const Series<Eigen::Vector3d> series = {{100, {0, 0, 0}}, {200, {1, 2, 3}}, {400, {3, 2, 1}}};
  EXPECT_FALSE(ValueAt(series, 99));
  EXPECT_FALSE(ValueAt(series, 401));
  EXPECT_EQ(*ValueAt(series, 100), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(*ValueAt(series, 400), Eigen::Vector3d(3, 2, 1));
  EXPECT_LT((*ValueAt(series, 150) - Eigen::Vector3d(0.5, 1, 1.5)).norm(), 1e-15);
  EXPECT_LT((*ValueAt(series, 300) - Eigen::Vector3d(2, 2, 2)).norm(), 1e-15);
}

TEST(DerivativeCheck, IsOfFourthOrder) {
  const auto f = [](const Eigen::VectorXd& x) -> Eigen::VectorXd {
    return Eigen::Vector2d(std::sin(x[0]), x[0] * x[1]);
  };
  const Eigen::Vector2d x(0.3, 0.7);
  Eigen::Matrix2d exact;
  exact << std::cos(0.3), 0, 0.7, 0.3;
  EXPECT_LT((NumericJacobian(f, x, 1e-3) - exact).norm(), 1e-12);
}

}  // namespace
}  // namespace flextip
