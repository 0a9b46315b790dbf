#include "control/direction_controller.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "allocation_counter.h"
#include "core/derivative_check.h"

namespace flextip {
namespace {

const Eigen::Matrix3d kTissue = Eigen::Vector3d(-4.0, -30.0, -10.0).asDiagonal();

/// A shaft bent by 1.5 N, its tip 320 mm beyond the port.
DirectionInput BentInput() {
  DirectionInput input;
  input.model.instrument = {0.6, 0.00238, 0.304, 0.0};
  input.model.p_RP = {0.28, 0.0, 0.0};
  input.model.f_tip_N = {0.2, -1.2, 0.8};
  input.model.force_known = true;
  return input;
}

ShaftRodState RodAt(const DirectionInput& input, const Eigen::Vector3d& p_RW) {
  ShaftProblem problem;
  problem.rod.rod = {0.6, 0.304, p_RW, input.model.p_RP, input.model.f_tip_N, {0, 0, 0}};
  ShaftRod solver;
  return solver.Solve(problem);
}

/// The rod whose load follows its tip by `K`, by iteration.
ShaftRodState RodInTissue(const DirectionInput& input, const Eigen::Vector3d& p_RW,
                          const Eigen::Matrix3d& K) {
  const Eigen::Vector3d p_start = RodAt(input, Eigen::Vector3d::Zero()).p_RE;
  DirectionInput moved = input;
  ShaftRodState rod = RodAt(moved, p_RW);
  for (int i = 0; i < 400; ++i) {
    const Eigen::Vector3d f = input.model.f_tip_N + K * (rod.p_RE - p_start);
    moved.model.f_tip_N += 0.2 * (f - moved.model.f_tip_N);
    rod = RodAt(moved, p_RW);
  }
  return rod;
}

DirectionInput AtRest() {
  DirectionInput input = BentInput();
  const ShaftRodState rod = RodAt(input, input.p_RW);
  input.p_RE = input.p_RE_desired = rod.p_RE;
  input.d_RE = input.d_RE_desired = rod.end.t;
  return input;
}

/// Steps on the rod itself until it rests.
DirectionOutput Settle(const DirectionOptions& options, DirectionInput& input) {
  DirectionController controller(options);
  DirectionOutput output;
  for (int i = 0; i < 60; ++i) {
    output = controller.Step(input);
    input.p_RW = output.p_RW_command;
    const ShaftRodState rod = RodAt(input, input.p_RW);
    EXPECT_TRUE(rod.IsUsable());
    input.p_RE = rod.p_RE;
    input.d_RE = rod.end.t;
  }
  return output;
}

double AngleTo(const DirectionInput& input) {
  return std::atan2(input.d_RE.cross(input.d_RE_desired).norm(),
                    input.d_RE.dot(input.d_RE_desired));
}

TEST(DirectionController, JacobiansMatchCentralDifferences) {
  const DirectionInput input = BentInput();
  for (const Eigen::Matrix3d& K : {Eigen::Matrix3d(Eigen::Matrix3d::Zero()), kTissue}) {
    const TipJacobians J = TipJacobiansOf(RodAt(input, input.p_RW), K);
    const auto f = [&](const Eigen::VectorXd& w) -> Eigen::VectorXd {
      const ShaftRodState rod = RodInTissue(input, w, K);
      Eigen::VectorXd out(6);
      out << rod.p_RE, rod.end.t;
      return out;
    };
    const Eigen::MatrixXd numeric = NumericJacobian(f, input.p_RW, 1e-3);
    EXPECT_LT((J.position - numeric.topRows(3)).norm(), 1e-5);
    EXPECT_LT((J.direction - numeric.bottomRows(3)).norm(), 1e-4);
  }
}

TEST(DirectionController, RegistrationAloneIsRightForAnUnbentShaft) {
  DirectionInput input = BentInput();
  input.model.f_tip_N.setZero();
  const ShaftRodState rod = RodAt(input, input.p_RW);
  const TipJacobians J = TipJacobiansOf(rod, Eigen::Matrix3d::Zero());
  const Eigen::Matrix3d by_thesis =
      DirectionByRegistration(J.position, input.p_RW, rod.p_RE, rod.end.t);
  EXPECT_LT((J.direction - by_thesis).norm(), 1e-9);
  EXPECT_GT(J.direction.norm(), 3.0);
}

TEST(DirectionController, HoldsThePlaceAloneWhenThatComesFirst) {
  DirectionInput input = AtRest();
  input.p_RE_desired += Eigen::Vector3d(0.002, -0.003, 0.004);
  input.d_RE_desired = (input.d_RE + Eigen::Vector3d(0.0, 0.1, 0.1)).normalized();
  const DirectionOutput output = Settle({.priority = DirectionPriority::kPositionFirst}, input);
  EXPECT_EQ(output.status, ControlStatus::kOk);
  EXPECT_EQ(output.direction_freedoms, 0);
  EXPECT_LT((input.p_RE - input.p_RE_desired).norm(), 1e-7);
  EXPECT_GT(AngleTo(input), 0.05);
  EXPECT_NEAR(output.direction_left_rad, AngleTo(input), 1e-6);  // and says so
}

TEST(DirectionController, TradesAFreeAxisForTheDirection) {
  // Across the shaft and across its bending: there the direction follows the tip best.
  DirectionInput input = AtRest();
  input.free_axis = {0.0, 0.0, 1.0};
  // A direction that can be reached so: that of the rod with the tip 10 mm along the free axis.
  DirectionInput there = AtRest();
  there.p_RE_desired += 0.01 * input.free_axis;
  Settle({.priority = DirectionPriority::kPositionFirst}, there);
  input.d_RE_desired = there.d_RE;
  const Eigen::Vector3d start = input.p_RE;
  EXPECT_GT(AngleTo(input), 0.02);
  const DirectionOutput output = Settle({.priority = DirectionPriority::kPositionFirst}, input);
  EXPECT_EQ(output.direction_freedoms, 1);
  EXPECT_LT(AngleTo(input), 1e-6);
  EXPECT_LT((input.p_RE - start).head<2>().norm(), 1e-6);  // the held part of the place
  EXPECT_NEAR(input.p_RE.z() - start.z(), 0.01, 1e-5);
}

TEST(DirectionController, WeightedStepIsTheLeastSquaresOne) {
  DirectionInput input = AtRest();
  input.p_RE_desired += Eigen::Vector3d(0.0005, -0.0004, 0.0003);
  input.d_RE_desired = (input.d_RE + Eigen::Vector3d(0.0, 0.004, -0.003)).normalized();
  const DirectionOptions options{.position_tolerance_m = 0.001, .direction_tolerance_rad = 0.004};
  DirectionController controller(options);
  const DirectionOutput output = controller.Step(input);
  ASSERT_FALSE(output.step_limited || output.damped);
  EXPECT_EQ(output.direction_freedoms, 2);
  const auto cost = [&](const Eigen::Vector3d& step) {
    const Eigen::Vector3d p = input.p_RE_desired - input.p_RE - output.J.position * step;
    const Eigen::Vector3d d = input.d_RE_desired - input.d_RE - output.J.direction * step;
    return (p / 0.001).squaredNorm() + (d / 0.004).squaredNorm();
  };
  const Eigen::Vector3d step = output.p_RW_command - input.p_RW;
  for (int i = 0; i < 3; ++i) {
    for (const double h : {-1e-5, 1e-5})
      EXPECT_LT(cost(step), cost(step + h * Eigen::Vector3d::Unit(i)));
  }
  // Neither is reached, and the more one weighs the nearer it is.
  double last_m = 1.0, last_rad = 0.0;
  for (const double tolerance : {1.0, 0.01, 0.001}) {
    const DirectionOutput o =
        DirectionController({.direction_tolerance_rad = tolerance}).Step(input);
    EXPECT_TRUE(last_m == 1.0 || o.position_left_m > last_m);
    EXPECT_TRUE(last_rad == 0.0 || o.direction_left_rad < last_rad);
    last_m = o.position_left_m;
    last_rad = o.direction_left_rad;
  }
}

TEST(DirectionController, BoundsItsStepAndHoldsStillOnBadInput) {
  for (const auto priority : {DirectionPriority::kWeighted, DirectionPriority::kPositionFirst}) {
    DirectionController controller({.priority = priority});
    DirectionInput far = AtRest();
    far.p_RE_desired += Eigen::Vector3d(0.0, 0.3, 0.0);
    DirectionOutput output = controller.Step(far);
    EXPECT_TRUE(output.step_limited);
    EXPECT_NEAR((output.p_RW_command - far.p_RW).norm(), 0.01, 1e-12);
    DirectionInput bad = AtRest();
    bad.d_RE_desired.x() = std::numeric_limits<double>::quiet_NaN();
    output = controller.Step(bad);
    EXPECT_EQ(output.status, ControlStatus::kBadInput);
    EXPECT_EQ(output.p_RW_command, bad.p_RW);
    bad = AtRest();
    bad.d_RE_desired.setZero();
    EXPECT_EQ(controller.Step(bad).status, ControlStatus::kBadInput);
    DirectionInput nowhere = AtRest();
    nowhere.model.p_RP.x() = 0.7;
    output = controller.Step(nowhere);
    EXPECT_EQ(output.status, ControlStatus::kNoModel);
    EXPECT_EQ(output.p_RW_command, nowhere.p_RW);
    DirectionInput unknown = AtRest();
    unknown.model.force_known = false;
    unknown.model.f_tip_N.setZero();
    EXPECT_EQ(controller.Step(unknown).status, ControlStatus::kStraightInstead);
  }
}

TEST(DirectionController, StepAllocatesNothing) {
  for (const auto priority : {DirectionPriority::kWeighted, DirectionPriority::kPositionFirst}) {
    DirectionController controller({.priority = priority});
    DirectionInput input = AtRest();
    input.free_axis = {0.0, 0.0, 1.0};
    input.model.tissue_stiffness_N_m = kTissue;
    controller.Step(input);
    const long before = AllocationCount();
    for (int i = 0; i < 10; ++i) input.p_RW = controller.Step(input).p_RW_command;
    EXPECT_EQ(AllocationCount(), before);
  }
}

}  // namespace
}  // namespace flextip
