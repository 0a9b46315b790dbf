// Error measures with known answers, at their limits and on bad input.
#include "control/motion_error.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "allocation_counter.h"
#include "core/linear_algebra.h"
#include "jacobian_pairs.h"

namespace flextip {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInf = std::numeric_limits<double>::infinity();
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Matrix3d SomeJacobian(unsigned seed) {
  std::mt19937_64 rng(seed);
  return DrawPair<3>(PairKind::kIndependent, rng).J;
}

TEST(StepError, IsTheLargestSingularValueOfG) {
  std::mt19937_64 rng(1);
  for (int i = 0; i < 500; ++i) {
    const PairKind kind = i % 2 == 0 ? PairKind::kIndependent : PairKind::kClose;
    const double gain = 0.1 + 0.01 * i;
    const JacobianPair<3> space = DrawPair<3>(kind, rng);
    const Matrix3d G = Matrix3d::Identity() - gain * space.J * space.J_hat.inverse();
    const StepError<3> error = FindStepError(space.J, space.J_hat, gain);
    const double rounding = 1e-13 * space.J_hat.inverse().norm() * space.J_hat.norm();
    EXPECT_NEAR(error.norm, SingularValues(G)[0], rounding * (1.0 + error.norm));
    EXPECT_NEAR((G * error.v_sigma).norm(), error.norm, rounding * (1.0 + error.norm));
    EXPECT_NEAR(error.v_sigma.norm(), 1.0, 1e-14);

    const JacobianPair<2> plane = DrawPair<2>(kind, rng);
    const Matrix2d G2 = Matrix2d::Identity() - gain * plane.J * plane.J_hat.inverse();
    const StepError<2> error2 = FindStepError(plane.J, plane.J_hat, gain);
    const double rounding2 = 1e-13 * plane.J_hat.inverse().norm() * plane.J_hat.norm();
    EXPECT_NEAR(error2.norm, SingularValues(G2)[0], rounding2 * (1.0 + error2.norm));
    EXPECT_NEAR((G2 * error2.v_sigma).norm(), error2.norm, rounding2 * (1.0 + error2.norm));
  }
}

TEST(StepError, BoundIsTheArcSineAndPiPastOne) {
  const Matrix3d I = Matrix3d::Identity();
  EXPECT_NEAR(FindStepError(Matrix3d(1.5 * I), I).phi_hat_max_rad, kPi / 6, 1e-15);
  EXPECT_NEAR(FindStepError(Matrix3d(2.0 * I), I).phi_hat_max_rad, kPi / 2, 1e-15);
  EXPECT_EQ(FindStepError(Matrix3d(2.001 * I), I).phi_hat_max_rad, kPi);
  EXPECT_NEAR(FindStepError(I, I, 0.25).norm, 0.75, 1e-15);
}

TEST(LargestAngle, IsZeroForEqualJacobiansAndScalings) {
  for (const double scale : {1.0, 0.01, 7.0}) {
    const Matrix3d J_hat = SomeJacobian(2);
    const AngleError<3> error = FindLargestAngle(scale * J_hat, J_hat);
    EXPECT_EQ(error.status, MotionErrorStatus::kOk);
    EXPECT_LT(error.phi_max_rad, 1e-14);
    EXPECT_NEAR(FindStepError(scale * J_hat, J_hat).norm, std::abs(1.0 - scale), 1e-13);
    const Matrix2d J2_hat = J_hat.topLeftCorner<2, 2>();
    EXPECT_LT(FindLargestAngle(Matrix2d(scale * J2_hat), J2_hat).phi_max_rad, 1e-14);
  }
}

TEST(LargestAngle, IsTheAngleOfARotation) {
  const Matrix3d J_hat = SomeJacobian(3);
  const Vector3d axis = Vector3d(1, -2, 0.5).normalized();
  for (const double angle : {1e-9, 1e-4, 0.3, kPi / 2, 2.0, 3.0, 3.1415926, kPi}) {
    const Matrix3d R = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    const AngleError<3> error = FindLargestAngle(R * J_hat, J_hat);
    EXPECT_EQ(error.status, MotionErrorStatus::kOk);
    EXPECT_NEAR(error.phi_max_rad, angle, 1e-12);
    EXPECT_NEAR(error.p_phi.dot(axis), 0.0, 1e-6);  // the angle is flat there
    EXPECT_NEAR(FindStepError(R * J_hat, J_hat).norm, 2.0 * std::sin(0.5 * angle), 1e-13);
    const Matrix2d R2 = Eigen::Rotation2Dd(-angle).toRotationMatrix();
    EXPECT_NEAR(FindLargestAngle(R2, Matrix2d::Identity()).phi_max_rad, angle, 1e-14);
  }
}

TEST(LargestAngle, OfAStretchIsKnown) {
  const Matrix3d J_hat = SomeJacobian(4);
  const Vector3d stretch(0.5, 1.0, 4.0);
  const AngleError<3> error = FindLargestAngle(stretch.asDiagonal() * J_hat, J_hat);
  EXPECT_NEAR(error.phi_max_rad, std::asin(3.5 / 4.5), 1e-12);
  EXPECT_NEAR(std::abs(error.p_phi[0]), std::sqrt(8.0 / 9.0), 1e-6);
  EXPECT_NEAR(error.p_phi[1], 0.0, 1e-6);
  const Matrix2d stretch2 = Vector2d(0.5, 4.0).asDiagonal();
  EXPECT_NEAR(FindLargestAngle(stretch2, Matrix2d::Identity()).phi_max_rad, std::asin(3.5 / 4.5),
              1e-14);
}

TEST(LargestAngle, OfAReflectionIsHalfATurn) {
  const Matrix3d J_hat = SomeJacobian(5);
  const Vector3d mirror = Vector3d(2, 1, -1).normalized();
  const Matrix3d H = Matrix3d::Identity() - 2.0 * mirror * mirror.transpose();
  AngleError<3> error = FindLargestAngle(H * J_hat, J_hat);
  EXPECT_NEAR(error.phi_max_rad, kPi, 1e-12);
  EXPECT_NEAR(std::abs(error.p_phi.dot(mirror)), 1.0, 1e-12);
  error = FindLargestAngle(-J_hat, J_hat);
  EXPECT_NEAR(error.phi_max_rad, kPi, 1e-12);
  const Matrix2d mirror2 = Vector2d(1, -1).asDiagonal();
  const AngleError<2> error2 = FindLargestAngle(mirror2, Matrix2d::Identity());
  EXPECT_EQ(error2.phi_max_rad, kPi);
  EXPECT_NEAR(std::abs(error2.p_phi[1]), 1.0, 1e-15);
}

/// In the plane the turn and the spread about it add up to no more than half a turn.
TEST(LargestAngle, IsHalfATurnWhereTurnAndSpreadAreMore) {
  const Matrix2d I = Matrix2d::Identity(), stretch = Vector2d(1.0, 3.0).asDiagonal();  // by 30
  for (const double turn_deg : {100.0, 149.0, 151.0, 175.0}) {
    const Matrix2d R = Eigen::Rotation2Dd(turn_deg * kPi / 180.0).toRotationMatrix();
    const AngleError<2> error = FindLargestAngle(R * stretch, I);
    EXPECT_NEAR(error.phi_max_rad, std::min(turn_deg + 30.0, 180.0) * kPi / 180.0, 1e-13);
    const Vector2d moved = R * stretch * error.p_phi;
    EXPECT_NEAR(std::cos(error.phi_max_rad), moved.normalized().dot(error.p_phi), 1e-13);
  }
}

/// A direction that is not moved has no angle; those near it do, and the largest is approached
/// there: half a turn less the angle between that direction and what can be reached.
TEST(LargestAngle, OfASingularTruthIsTheSupremum) {
  const Matrix3d I = Matrix3d::Identity();
  Matrix3d J = Vector3d(1.0, 0.7, 0.0).asDiagonal();
  EXPECT_EQ(FindLargestAngle(J, I).status, MotionErrorStatus::kSingularTruth);
  EXPECT_TRUE(FindLargestAngle(J, I).IsUsable());
  EXPECT_NEAR(FindLargestAngle(J, I).phi_max_rad, kPi / 2, 1e-12);
  J << 1, 0, 1, 0, 1, 0, 0, 0, 0;
  EXPECT_NEAR(FindLargestAngle(J, I).phi_max_rad, 0.75 * kPi, 1e-12);
  EXPECT_NEAR(std::abs(FindLargestAngle(J, I).p_phi.dot(Vector3d(1, 0, -1))), std::sqrt(2.0),
              1e-12);
  J << 1, 1, 0, 0, 0, 0, 0, 0, 0;  // rank 1
  EXPECT_NEAR(FindLargestAngle(J, I).phi_max_rad, 0.75 * kPi, 1e-12);
  Matrix2d J2;
  J2 << 1, 1, 0, 0;
  const AngleError<2> plane = FindLargestAngle(J2, Matrix2d::Identity());
  EXPECT_EQ(plane.status, MotionErrorStatus::kSingularTruth);
  EXPECT_NEAR(plane.phi_max_rad, 0.75 * kPi, 1e-14);
  EXPECT_NEAR(std::abs(plane.p_phi.dot(Vector2d(1, -1))), std::sqrt(2.0), 1e-14);
  // Nothing moves at all.
  const AngleError<3> none = FindLargestAngle(Matrix3d::Zero(), I);
  EXPECT_EQ(none.status, MotionErrorStatus::kSingularTruth);
  EXPECT_EQ(none.phi_max_rad, kPi);
  EXPECT_EQ(none.p_phi, Vector3d::Zero());
}

TEST(LargestAngle, OfASingularTruthDoesNotHangOnRounding) {
  std::mt19937_64 rng(8);
  int below = 0;
  for (int i = 0; i < 200; ++i) {
    const JacobianPair<3> pair = DrawPair<3>(PairKind::kIndependent, rng);
    Matrix3d J = pair.J;
    J.col(2) = J.col(0) - 0.3 * J.col(1);  // rank 2, the determinant of either sign by rounding
    const AngleError<3> error = FindLargestAngle(J, pair.J_hat);
    ASSERT_EQ(error.status, MotionErrorStatus::kSingularTruth);
    // The direction that is not moved, and the normal of those that are reached.
    const Vector3d unmoved = (pair.J_hat * Vector3d(1.0, -0.3, -1.0)).normalized();
    const Vector3d normal = J.col(0).cross(J.col(1)).normalized();
    const double supremum = kPi - std::asin(std::abs(unmoved.dot(normal)));
    EXPECT_GT(error.phi_max_rad, supremum - 1e-10);
    if (error.phi_max_rad < supremum + 1e-10) ++below;
    const Matrix3d rounded = J + 1e-17 * J.norm() * DrawPair<3>(PairKind::kIndependent, rng).J;
    EXPECT_NEAR(FindLargestAngle(rounded, pair.J_hat).phi_max_rad, error.phi_max_rad, 1e-9);
  }
  EXPECT_GT(below, 20);  // where no other direction is turned further
}

/// (2.10) holds for every gain, and is loose only by the gain: at the best one, s / m of the worst
/// direction, ||G|| is the sine of phi_max, as long as that is below 90 degrees.
TEST(LargestAngle, IsTheBoundAtTheBestGain) {
  std::mt19937_64 rng(9);
  int below_90 = 0;
  const auto compare = [&](const auto& J, const auto& J_hat) {
    const auto angle = FindLargestAngle(J, J_hat);
    for (const double gain : {0.1, 0.5, 1.0, 2.0}) {
      EXPECT_GE(FindStepError(J, J_hat, gain).phi_hat_max_rad, angle.phi_max_rad - 1e-12);
    }
    if (angle.phi_max_rad > 1.5) return;
    ++below_90;
    const auto moved = (J * J_hat.inverse() * angle.p_phi).eval();
    const double best = moved.dot(angle.p_phi) / moved.squaredNorm();
    const double sine = std::sin(angle.phi_max_rad);
    EXPECT_NEAR(FindStepError(J, J_hat, best).norm, sine, 1e-9);
    EXPECT_GT(FindStepError(J, J_hat, 1.2 * best).norm, sine);
    EXPECT_GT(FindStepError(J, J_hat, 0.8 * best).norm, sine);
  };
  for (int i = 0; i < 500; ++i) {
    const PairKind kind = i % 2 == 0 ? PairKind::kClose : PairKind::kFarther;
    const JacobianPair<3> space = DrawPair<3>(kind, rng);
    compare(space.J, space.J_hat);
    const JacobianPair<2> plane = DrawPair<2>(kind, rng);
    compare(plane.J, plane.J_hat);
  }
  EXPECT_GT(below_90, 600);
}

TEST(LargestAngle, DoesNotHangOnUnits) {
  const Matrix3d J = SomeJacobian(6), J_hat = SomeJacobian(7);
  const double angle = FindLargestAngle(J, J_hat).phi_max_rad;
  for (const double scale : {1e-200, 1e-9, 1e9, 1e200}) {
    EXPECT_NEAR(FindLargestAngle(scale * J, J_hat).phi_max_rad, angle, 1e-11);
    EXPECT_NEAR(FindLargestAngle(J, scale * J_hat).phi_max_rad, angle, 1e-11);
  }
}

template <class Error>
void ExpectPessimistic(const Error& error, MotionErrorStatus status) {
  EXPECT_EQ(error.status, status);
  EXPECT_FALSE(error.IsUsable());
}

TEST(MotionError, SaysWhatIsWrongAndFearsTheWorst) {
  const Matrix3d I = Matrix3d::Identity();
  Matrix3d singular = SomeJacobian(10);
  singular.row(1) = 2.0 * singular.row(0);
  for (const Matrix3d& J_hat : {singular, Matrix3d(Matrix3d::Zero())}) {
    ExpectPessimistic(FindStepError(I, J_hat), MotionErrorStatus::kSingularEstimate);
    ExpectPessimistic(FindLargestAngle(I, J_hat), MotionErrorStatus::kSingularEstimate);
    EXPECT_EQ(FindStepError(I, J_hat).norm, kInf);
    EXPECT_EQ(FindStepError(I, J_hat).phi_hat_max_rad, kPi);
    EXPECT_EQ(FindLargestAngle(I, J_hat).phi_max_rad, kPi);
  }
  const Matrix2d singular2 = Matrix2d::Constant(0.1);
  ExpectPessimistic(FindStepError(Matrix2d::Identity(), singular2),
                    MotionErrorStatus::kSingularEstimate);
  ExpectPessimistic(FindLargestAngle(Matrix2d::Identity(), singular2),
                    MotionErrorStatus::kSingularEstimate);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInf}) {
    Matrix3d J = I;
    J(2, 1) = bad;
    ExpectPessimistic(FindStepError(J, I), MotionErrorStatus::kBadInput);
    ExpectPessimistic(FindStepError(I, J), MotionErrorStatus::kBadInput);
    ExpectPessimistic(FindStepError(I, I, bad), MotionErrorStatus::kBadInput);
    ExpectPessimistic(FindLargestAngle(J, I), MotionErrorStatus::kBadInput);
    ExpectPessimistic(FindLargestAngle(I, J), MotionErrorStatus::kBadInput);
    const Matrix2d J2 = J.bottomRightCorner<2, 2>();
    ExpectPessimistic(FindStepError(J2, Matrix2d::Identity()), MotionErrorStatus::kBadInput);
    ExpectPessimistic(FindLargestAngle(Matrix2d::Identity(), J2), MotionErrorStatus::kBadInput);
  }
  ExpectPessimistic(FindStepError(I, I, 0.0), MotionErrorStatus::kBadInput);
  ExpectPessimistic(FindStepError(I, I, -1.0), MotionErrorStatus::kBadInput);
}

/// Entries of zeros, ones and wildly different sizes: everything degenerate at once.
TEST(MotionError, IsNeverNotANumber) {
  std::mt19937_64 rng(11);
  std::discrete_distribution<int> which{4, 2, 1, 1, 1, 1};
  constexpr std::array<double, 6> kEntries{0.0, 1.0, -1.0, 1e-8, 1e-160, -1e150};
  const auto draw = [&] { return kEntries[which(rng)]; };
  int usable = 0;
  for (int i = 0; i < 20000; ++i) {
    const Matrix3d J = Matrix3d::NullaryExpr(draw), J_hat = Matrix3d::NullaryExpr(draw);
    const StepError<3> step = FindStepError(J, J_hat);
    const AngleError<3> angle = FindLargestAngle(J, J_hat);
    ASSERT_FALSE(std::isnan(step.norm)) << J << "\n\n" << J_hat;
    ASSERT_TRUE(step.v_sigma.allFinite() && step.phi_hat_max_rad >= 0.0);
    ASSERT_TRUE(angle.p_phi.allFinite()) << J << "\n\n" << J_hat;
    ASSERT_TRUE(angle.phi_max_rad >= 0.0 && angle.phi_max_rad <= kPi) << J << "\n\n" << J_hat;
    usable += angle.IsUsable();
    const AngleError<2> plane =
        FindLargestAngle(Matrix2d(J.topLeftCorner<2, 2>()), Matrix2d(J_hat.topLeftCorner<2, 2>()));
    ASSERT_TRUE(plane.p_phi.allFinite());
    ASSERT_TRUE(plane.phi_max_rad >= 0.0 && plane.phi_max_rad <= kPi);
  }
  EXPECT_GT(usable, 1000);
}

TEST(MotionError, AllocatesNothing) {
  std::mt19937_64 rng(12);
  for (int i = 0; i < 50; ++i) {
    const JacobianPair<3> pair = DrawPair<3>(static_cast<PairKind>(i % kPairKinds), rng);
    const long before = AllocationCount();
    const AngleError<3> angle = FindLargestAngle(pair.J, pair.J_hat);
    const StepError<3> step = FindStepError(pair.J, pair.J_hat);
    EXPECT_EQ(AllocationCount(), before);
    EXPECT_TRUE(angle.IsUsable() && step.IsUsable());
  }
}

}  // namespace
}  // namespace flextip
