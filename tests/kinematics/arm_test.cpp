#include "kinematics/arm.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/derivative_check.h"
#include "core/draw_vector.h"
#include "kinematics/joint_step.h"
#include "kinematics/plane_beam.h"
#include "kinematics/straight.h"

namespace flextip {
namespace {

Eigen::Vector3d AllowedAngles(const PhantomArm& arm, std::mt19937& rng) {
  std::uniform_real_distribution<double> uniform(-2.0, 1.3);
  for (;;) {
    const Eigen::Vector3d theta = DrawVector<3>(uniform, rng);
    if (arm.WithinLimits(theta)) return theta;
  }
}

TEST(PlanarArm, HomeIsTheOriginAndLinksLieAsInTheThesis) {
  const PlanarArm arm;
  EXPECT_LT(arm.Wrist({0, 0}).norm(), 1e-16);
  EXPECT_TRUE(arm.WithinLimits({0, 0}));
  // First link raised by a right angle, second link carried along: from (z, y) = (-0.21, 0.21),
  // up by 0.21, then forward by 0.21.
  EXPECT_LT((arm.Wrist({M_PI / 2, 0}) - Eigen::Vector2d(0.0, 0.42)).norm(), 1e-15);
  // Elbow opened by a right angle: both links in line along z.
  EXPECT_LT((arm.Wrist({0, M_PI / 2}) - Eigen::Vector2d(0.21, 0.21)).norm(), 1e-15);
}

TEST(PlanarArm, LimitsAreThoseOf231) {
  const PlanarArm arm;
  EXPECT_TRUE(arm.WithinLimits({1.19, 0.99}));
  EXPECT_FALSE(arm.WithinLimits({1.21, 0.0}));
  EXPECT_FALSE(arm.WithinLimits({0.0, 1.01}));
  EXPECT_FALSE(arm.WithinLimits({0.5, -0.71}));
  EXPECT_FALSE(arm.WithinLimits({-0.2, -0.11}));  // the sum
  EXPECT_TRUE(arm.WithinLimits({-0.2, -0.09}));
}

TEST(Arms, JacobiansMatchCentralDifferences) {
  const PhantomArm arm;
  std::mt19937 rng(5);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d theta = AllowedAngles(arm, rng);
    const Eigen::MatrixXd J3 =
        NumericJacobian([&](const Eigen::VectorXd& q) { return arm.Wrist(q); }, theta, 1e-3);
    EXPECT_LT((J3 - arm.Jacobian(theta)).norm(), 1e-11);
    const Eigen::Vector2d links = theta.tail<2>();
    const Eigen::MatrixXd J2 =
        NumericJacobian([&](const Eigen::VectorXd& q) { return arm.links.Wrist(q); }, links, 1e-3);
    EXPECT_LT((J2 - arm.links.Jacobian(links)).norm(), 1e-11);
    // Within its limits the elbow never straightens or folds.
    EXPECT_GT(std::abs(J2.determinant()), 0.5 * 0.21 * 0.21);
  }
}

TEST(Arms, InverseReturnsTheJointAngles) {
  const PhantomArm arm;
  std::mt19937 rng(6);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d theta = AllowedAngles(arm, rng);
    // Left out: a wrist behind or on the base's axis, which the base reaches by turning round.
    if (arm.links.Wrist(theta.tail<2>()).x() + 0.21 < 0.01) continue;
    const PhantomArm::Inverse inverse = arm.Solve(arm.Wrist(theta));
    EXPECT_EQ(inverse.status, ArmStatus::kOk);
    EXPECT_LT((inverse.theta - theta).norm(), 1e-9);
    const PlanarArm::Inverse planar = arm.links.Solve(arm.links.Wrist(theta.tail<2>()));
    EXPECT_EQ(planar.status, ArmStatus::kOk);
    EXPECT_LT((planar.theta - theta.tail<2>()).norm(), 1e-9);
  }
}

TEST(Arms, InverseSaysWhyNot) {
  const PhantomArm arm;
  EXPECT_EQ(arm.Solve({0, 0, 1.0}).status, ArmStatus::kUnreachable);
  EXPECT_EQ(arm.links.Solve({-0.21, 0.21}).status, ArmStatus::kUnreachable);  // on the shoulder
  EXPECT_EQ(arm.Solve({0, 0.21, 0.209}).status, ArmStatus::kOutsideLimits);   // almost stretched
  EXPECT_EQ(arm.Solve({0.2, 0, -0.18}).status, ArmStatus::kOutsideLimits);    // base too far
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(arm.Solve({0, nan, 0}).status, ArmStatus::kBadInput);
}

TEST(JointStep, EqualsTheCartesianStepToFirstOrder) {
  const PhantomArm arm;
  const Eigen::Vector3d theta(0.1, 0.2, -0.1), p_port(0.01, -0.02, 0.16);
  const double L = 0.32;
  const StraightShaft shaft = SolveStraight(arm.Wrist(theta), p_port, L);
  ASSERT_TRUE(shaft.IsUsable());
  double last = 0.0;
  for (const double move : {4e-3, 2e-3, 1e-3}) {
    JointStepInput<3> input;
    input.theta = theta;
    input.p_tip = shaft.p_tip;
    input.p_tip_desired = shaft.p_tip + move * Eigen::Vector3d(1, 2, -1).normalized();
    input.J_tip_wrist = shaft.J_tip_wrist;
    input.J_wrist_joints = arm.Jacobian(theta);
    const JointStepResult<3> step = JointStep(input);
    EXPECT_EQ(step.status, JointStepStatus::kOk);
    const Eigen::Vector3d cartesian =
        arm.Wrist(theta) + shaft.J_tip_wrist.inverse() * (input.p_tip_desired - shaft.p_tip);
    const double difference = (arm.Wrist(step.theta_desired) - cartesian).norm();
    EXPECT_LT(difference, 5.0 * move * move);
    // What is left is of second order: half the move, a quarter of it.
    if (last > 0) {
      EXPECT_NEAR(last / difference, 4.0, 0.15);
    }
    last = difference;
  }
}

// The planar experiment of 2.3 and chapter 4 with a bent shaft: (3.4) takes the tip to its goal.
TEST(JointStep, TakesABentShaftsTipToItsGoal) {
  const PlanarArm arm;
  PlaneBeamProblem problem;
  problem.p_port = {0.16, 0.0};
  problem.length_m = 0.32;
  problem.load_over_EI = 6.0;
  Eigen::Vector2d theta(0.05, 0.05);
  problem.p_wrist = arm.Wrist(theta);
  PlaneBeam beam = SolvePlaneBeam(problem);
  const Eigen::Vector2d goal = beam.p_tip + Eigen::Vector2d(0.008, -0.01);
  for (int i = 0; i < 5; ++i) {
    JointStepInput<2> input;
    input.theta = theta;
    input.p_tip = beam.p_tip;
    input.p_tip_desired = goal;
    input.J_tip_wrist = beam.J_tip_wrist;
    input.J_wrist_joints = arm.Jacobian(theta);
    theta = JointStep(input).theta_desired;
    problem.p_wrist = arm.Wrist(theta);
    beam = SolvePlaneBeam(problem);
  }
  EXPECT_LT((beam.p_tip - goal).norm(), 1e-12);
  EXPECT_TRUE(arm.WithinLimits(theta));
}

TEST(JointStep, IsBoundedNearASingularPosition) {
  const PlanarArm arm;
  double last = 1e300;
  for (const double elbow : {0.3, 0.1, 1e-2, 1e-4, 0.0}) {  // from stretched
    JointStepInput<2> input;
    input.theta = {0.0, M_PI / 2 - elbow};
    input.p_tip_desired = {0.001, 0.0};  // outward, the direction that is lost
    input.J_wrist_joints = arm.Jacobian(input.theta);
    input.min_singular_value_m = 0.02;
    const JointStepResult<2> step = JointStep(input);
    const double turn = (step.theta_desired - input.theta).norm();
    EXPECT_LE(turn, 0.001 / 0.02 + 1e-12);
    EXPECT_EQ(step.status, step.smallest_singular_value_m < 0.02 ? JointStepStatus::kDamped
                                                                 : JointStepStatus::kOk);
    if (elbow < 0.1) {
      EXPECT_LT(turn, last);
    }
    last = turn;
  }
}

TEST(JointStep, HoldsStillOnBadInput) {
  JointStepInput<2> input;
  input.theta = {0.1, 0.2};
  input.p_tip_desired[0] = std::numeric_limits<double>::quiet_NaN();
  const JointStepResult<2> step = JointStep(input);
  EXPECT_EQ(step.status, JointStepStatus::kBadInput);
  EXPECT_EQ(step.theta_desired, input.theta);
}

}  // namespace
}  // namespace flextip
