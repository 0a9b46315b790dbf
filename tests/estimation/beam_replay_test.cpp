// Chapter 4's simulated moves without noise: a 600 mm shaft under 2 N, port 280 mm from the wrist,
// 10 mm along each axis in steps of 2 mm, every controller reading the true tip and the slopes. The
// plant is the exact rod. How far does the tip stray from its line?
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "estimation/slope_fit.h"
#include "kinematics/rod.h"
#include "kinematics/straight.h"
#include "tests/kinematics/printed_jacobian.h"

namespace flextip {
namespace {

constexpr double kLength = 0.6, kStiffness = 0.304;
const Eigen::Vector3d kPort(0.28, 0, 0), kForce(0, -2, 0);

RodState Plant(RodSolver& solver, const Eigen::Vector3d& wrist) {
  const RodState state =
      solver.Solve({kLength, kStiffness, wrist, kPort, kForce, Eigen::Vector3d::Zero()});
  EXPECT_TRUE(state.IsUsable());
  return state;
}

using Jacobian = std::function<Eigen::Matrix3d(const RodState&, const BeamFit&)>;

// Largest distance from the line at the ends of the steps, of moves along +-`axis` (m).
double Deviation(const Jacobian& jacobian, const Eigen::Vector3d& axis) {
  double largest = 0.0;
  for (const Eigen::Vector3d& direction : {axis, Eigen::Vector3d(-axis)}) {
    RodSolver solver;
    Eigen::Vector3d wrist = Eigen::Vector3d::Zero();
    RodState state = Plant(solver, wrist);
    const Eigen::Vector3d start = state.tip.p;
    for (int step = 1; step <= 12; ++step) {
      const Eigen::Vector3d goal = start + std::min(0.002 * step, 0.01) * direction;
      const BeamFit fit =
          FitFromSlopes(wrist, state.tip.p, state.wrist.t, state.tip.t, kLength, {});
      EXPECT_EQ(fit.status, BeamStatus::kOk);
      wrist += jacobian(state, fit).inverse() * (goal - state.tip.p);
      state = Plant(solver, wrist);
      const Eigen::Vector3d moved = state.tip.p - start;
      largest = std::max(largest, (moved - moved.dot(direction) * direction).norm());
    }
    EXPECT_LT((state.tip.p - start - 0.01 * direction).norm(), 1e-4);
  }
  return largest;
}

Eigen::Matrix3d Straight(const RodState& state, const BeamFit&) {
  return SolveStraight(state.wrist.p, kPort, kLength).J_tip_wrist;
}
Eigen::Matrix3d Printed(const RodState&, const BeamFit& fit) {
  const double a = fit.a, y = BeamPort(fit, Eigen::Vector3d::Zero()).dot(fit.R_RM.col(1));
  Eigen::Matrix3d J_M = Eigen::Matrix3d::Zero();
  J_M.topLeftCorner<2, 2>() = PrintedJacobian5(y, a, kLength, 0.0);
  J_M(2, 2) = -(kLength - a) / a;
  return fit.R_RM * J_M * fit.R_RM.transpose();
}
Eigen::Matrix3d PortForce(const RodState&, const BeamFit& fit) {
  return BeamJacobian(fit, BeamLoadLaw::kPortForce);
}
Eigen::Matrix3d TipForce(const RodState&, const BeamFit& fit) {
  return BeamJacobian(fit, BeamLoadLaw::kTipForce);
}
Eigen::Matrix3d Exact(const RodState& state, const BeamFit&) { return state.J_tip_wrist(); }

// The thesis: at most 1.8 mm straight and 0.8 mm with flexion, with noise; along y 0.9 and 0.1.
TEST(Chapter4Moves, HoldingTheTipForceTakesAwayNearlyAllTheDeviation) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();
  const double um = 1e-6;
  EXPECT_NEAR(Deviation(Straight, x), 1890 * um, 10 * um);
  EXPECT_NEAR(Deviation(Straight, y), 903 * um, 10 * um);
  EXPECT_NEAR(Deviation(Printed, x), 693 * um, 10 * um);
  EXPECT_NEAR(Deviation(Printed, y), 40 * um, 5 * um);
  EXPECT_NEAR(Deviation(PortForce, x), 982 * um, 10 * um);
  EXPECT_NEAR(Deviation(PortForce, y), 22 * um, 5 * um);
  EXPECT_NEAR(Deviation(TipForce, x), 51 * um, 5 * um);
  EXPECT_NEAR(Deviation(TipForce, y), 86 * um, 5 * um);
  EXPECT_LT(Deviation(Exact, x), 20 * um);
  EXPECT_LT(Deviation(Exact, y), 20 * um);
}

// What the small-angle beam leaves at that load, from the known force: with the straight length
// (3.6), and with the chord drawn together (5.22).
TEST(Chapter4Moves, TheBeamsTipIsCentimetresOff) {
  RodSolver solver;
  const Eigen::Vector3d wrist = Eigen::Vector3d::Zero(), tip = Plant(solver, wrist).tip.p;
  const BeamFit fit = SolveBeam(wrist, kPort, kForce, kStiffness, kLength);
  EXPECT_NEAR((kLength * fit.R_RM.col(0) - tip).norm(), 0.0181, 0.0002);
  EXPECT_NEAR((BeamTip(fit, wrist) - tip).norm(), 0.0125, 0.0002);
}

}  // namespace
}  // namespace flextip
