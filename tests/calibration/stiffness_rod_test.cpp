// The rod with a taper: against the rod of kinematics/, against the plant, and its derivatives
// against differences.
#include "calibration/shaft/stiffness_rod.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/derivative_check.h"
#include "kinematics/effect_rod.h"
#include "tests/calibration/hung_masses.h"

namespace flextip {
namespace {

TaperedRodProblem Problem() {
  TaperedRodProblem problem;
  problem.rod.length_m = 0.6;
  problem.rod.bending_stiffness_Nm2 = 0.304;
  problem.rod.p_wrist = {-0.02, 0.03, -0.01};
  problem.rod.p_port = {0.28, 0.01, 0.02};
  problem.rod.f_tip = {0.1, 0.3, -0.4};
  problem.rod.q_weight = {0, 0, -0.1};
  problem.y_wrist = {0.1, 0.8, 0.5};
  return problem;
}

class StiffnessRodAndTaper : public ::testing::TestWithParam<double> {};

TEST_P(StiffnessRodAndTaper, IsTheRodOfKinematics) {
  TaperedRodProblem problem = Problem();
  problem.rod.stiffness_taper = GetParam();
  TaperedRodSolver solver;
  const double stations[] = {0.5, 0.12};
  const auto tapered = solver.Solve(problem, stations);
  EffectRodProblem other{problem.rod, {}};
  other.effects.y_wrist = problem.y_wrist;
  const RodStation others[] = {{0.5}, {0.12}};
  EffectRodSolver reference;
  const auto exact = reference.Solve(other, others);
  ASSERT_TRUE(tapered.usable && exact.IsUsable());
  EXPECT_NEAR(tapered.s_port_m, exact.s_port_m, 1e-8);
  // A taper shows what Runge and Kutta's steps leave: 1e-7 of the length.
  const double integrated_m = GetParam() == 0 ? 1e-8 : 6e-8;
  const auto same = [&](const TaperedRodSection& a, const EffectRodSection& b) {
    EXPECT_LT((a.p - b.p).norm(), integrated_m);
    EXPECT_LT((a.t - b.t).norm(), 1e-7);
    EXPECT_LT((a.y - b.y).norm(), 1e-7);
    EXPECT_LT((a.m - b.m).norm(), 1e-7);
    EXPECT_LT((a.dp.leftCols<10>() - b.dp.leftCols<10>()).norm(), 1e-6);
    EXPECT_LT((a.dm.leftCols<10>() - b.dm.leftCols<10>()).norm(), 1e-5);
  };
  same(tapered.wrist, exact.wrist);
  same(tapered.tip, exact.tip);
  for (int i = 0; i < 2; ++i) same(tapered.stations[i], exact.stations[i]);
}
INSTANTIATE_TEST_SUITE_P(Some, StiffnessRodAndTaper, ::testing::Values(0.0, 0.5, -0.9));

TEST(StiffnessRod, BendsAsThePlantDoes) {
  test_support::Bench bench;
  bench.effects.taper = 0.3;  // 1 + 0.3 (1 - 2 s / L)
  const std::vector<test_support::HungMass> masses = {{{0.0, 0.01, 0.02}, {0.1, 0.3, -0.4}},
                                                      {{-0.1, 0.0, 0.0}, {0.0, -0.3, 0.1}},
                                                      {{0.08, 0.0, -0.02}, {0.0, 0.5, 0.5}}};
  const auto shapes = Hang(bench, masses);
  TaperedRodSolver solver;
  double by_taper_m = 0;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    TaperedRodProblem problem;
    problem.rod = {0.6, 0.304, masses[i].p_RW, bench.p_RP, masses[i].f_N};
    problem.rod.stiffness_taper = -0.6;
    const auto rod = solver.Solve(problem);
    ASSERT_TRUE(rod.usable);
    // The chain's links leave some microns.
    EXPECT_LT((rod.tip.p - shapes[i].T_RE().p).norm(), 1e-5);
    EXPECT_LT((rod.wrist.t - shapes[i].T_RW().R.col(0)).norm(), 1e-4);
    problem.rod.stiffness_taper = 0.0;
    by_taper_m = std::max(by_taper_m, (solver.Solve(problem).tip.p - rod.tip.p).norm());
  }
  EXPECT_GT(by_taper_m, 1e-3);  // it matters
}

TEST(StiffnessRod, DerivativesAreThoseOfDifferences) {
  TaperedRodProblem problem = Problem();
  problem.rod.stiffness_taper = 0.5;
  const double stations[] = {0.12};
  Eigen::VectorXd at(tapered_input::kCount);
  at << problem.rod.p_wrist, problem.rod.p_port, problem.rod.f_tip,
      std::log(problem.rod.bending_stiffness_Nm2), problem.rod.stiffness_taper;
  const auto solve = [&](const Eigen::VectorXd& u) {
    TaperedRodProblem moved = problem;
    moved.rod.p_wrist = u.head<3>();
    moved.rod.p_port = u.segment<3>(3);
    moved.rod.f_tip = u.segment<3>(6);
    moved.rod.bending_stiffness_Nm2 = std::exp(u[9]);
    moved.rod.stiffness_taper = u[10];
    return TaperedRodSolver().Solve(moved, stations);
  };
  const auto numeric = NumericJacobian(
      [&](const Eigen::VectorXd& u) {
        const auto rod = solve(u);
        Eigen::VectorXd out(15);
        out << rod.tip.p, rod.tip.t, rod.wrist.t, rod.stations[0].y, rod.stations[0].m;
        return out;
      },
      at, 1e-3);
  const auto rod = solve(at);
  ASSERT_TRUE(rod.usable);
  Eigen::MatrixXd exact(15, tapered_input::kCount);
  exact << rod.tip.dp, rod.tip.dt, rod.wrist.dt, rod.stations[0].dy, rod.stations[0].dm;
  EXPECT_LT((exact - numeric).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace flextip
