#include "control/supervision/worst_motion.h"

#include <gtest/gtest.h>

#include <random>

#include "control/motion_error.h"
#include "core/draw_vector.h"

namespace flextip {
namespace {

/// Chapter 4's shaft under a force of the tissue, and how well wrist, port and force are known.
struct Bent {
  ShaftEstimate estimate;
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();
  ControllerOptions options;

  explicit Bent(double part = 1.0) {
    estimate.status = EstimateStatus::kOk;
    estimate.model.instrument = {0.6, 0.00238, 0.304, 0.0};
    estimate.model.p_RP = {0.28, 0.0, 0.0};
    estimate.model.f_tip_N = {0.1, -1.5, 0.3};
    estimate.model.force_known = true;
    Eigen::Matrix<double, 9, 1> sd;
    sd << 5e-5, 5e-5, 5e-5, 3e-4, 3e-4, 3e-4, 1.0, 0.05, 0.05;
    sd *= part;
    estimate.covariance = sd.cwiseAbs2().asDiagonal();
    estimate.covariance(7, 8) = estimate.covariance(8, 7) = 0.5 * sd[7] * sd[8];
  }

  Eigen::Matrix3d JacobianAt(const Eigen::Matrix<double, 9, 1>& x) const {
    ShaftModel model = estimate.model;
    model.p_RP += x.segment<3>(3);
    model.f_tip_N += x.tail<3>();
    const ShaftRodState rod = ShaftRod().Solve(RodOf(model, p_RW + x.head<3>()));
    EXPECT_TRUE(rod.IsUsable());
    return rod.dp_RE.leftCols<3>();
  }
  Eigen::Matrix3d Own() const { return JacobianAt(Eigen::Matrix<double, 9, 1>::Zero()); }
};

TEST(WorstMotion, OfATrueModelWithoutDoubtIsNone) {
  const Bent bent(1e-9);
  const WorstMotion worst =
      FindWorstMotion(bent.Own(), bent.estimate, bent.p_RW, bent.options, 2.0);
  ASSERT_TRUE(worst.found);
  EXPECT_LT(worst.angle_rad, 1e-7);
}

TEST(WorstMotion, OfAWrongJacobianIsTheExactAngleWhereThereIsNoDoubt) {
  const Bent bent(1e-9);
  Eigen::Matrix3d J_hat = bent.Own();
  J_hat.col(0) += Eigen::Vector3d(0.1, -0.2, 0.05);
  const WorstMotion worst = FindWorstMotion(J_hat, bent.estimate, bent.p_RW, bent.options, 2.0);
  const AngleError<3> exact = FindLargestAngle(bent.Own(), J_hat);
  ASSERT_TRUE(worst.found);
  EXPECT_NEAR(worst.angle_rad, exact.phi_max_rad, 1e-6);
  EXPECT_NEAR(worst.angle_at_estimate_rad, exact.phi_max_rad, 1e-9);
  EXPECT_NEAR(std::abs(worst.direction.dot(exact.p_phi)), 1.0, 1e-6);
}

/// Twenty thousand rods drawn on the ellipsoid: none may be worse, and the worst is not far.
TEST(WorstMotion, IsNotExceededByRodsDrawnWithinTheDoubt) {
  const Bent bent;
  const Eigen::Matrix3d J_hat = bent.Own();
  const WorstMotion worst = FindWorstMotion(J_hat, bent.estimate, bent.p_RW, bent.options, 2.0);
  ASSERT_TRUE(worst.found);
  const Matrix9d root = bent.estimate.covariance.llt().matrixL();
  std::mt19937_64 random(20260);
  std::normal_distribution<double> normal;
  double largest = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    Eigen::Matrix<double, 9, 1> z;
    for (int j = 0; j < 9; ++j) z[j] = normal(random);
    const Eigen::Matrix<double, 9, 1> x = 2.0 * (root * z.normalized());
    largest = std::max(largest, FindLargestAngle(bent.JacobianAt(x), J_hat).phi_max_rad);
  }
  EXPECT_LE(largest, worst.angle_rad * (1.0 + 1e-6));
  EXPECT_GT(largest, 0.8 * worst.angle_rad);
}

TEST(WorstMotion, GrowsWithTheDoubt) {
  const Bent bent;
  double before = 0.0;
  for (const double deviations : {0.5, 1.0, 2.0, 3.0}) {
    const WorstMotion worst =
        FindWorstMotion(bent.Own(), bent.estimate, bent.p_RW, bent.options, deviations);
    EXPECT_GT(worst.angle_rad, before);
    before = worst.angle_rad;
  }
}

TEST(WorstMotion, IsHalfATurnWhereTheShaftMayBuckle) {
  Bent bent;
  bent.estimate.covariance(6, 6) = 400.0;  // 20 N along the shaft
  const WorstMotion worst =
      FindWorstMotion(bent.Own(), bent.estimate, bent.p_RW, bent.options, 2.0);
  ASSERT_TRUE(worst.found);
  EXPECT_EQ(worst.angle_rad, std::numbers::pi);
}

TEST(WorstMotion, IsNotFoundWithoutAnEstimate) {
  Bent bent;
  bent.estimate.status = EstimateStatus::kNotConverged;
  EXPECT_FALSE(FindWorstMotion(bent.Own(), bent.estimate, bent.p_RW, bent.options, 2.0).found);
}

}  // namespace
}  // namespace flextip
