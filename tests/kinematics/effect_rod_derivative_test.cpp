#include <gtest/gtest.h>

#include <array>

#include "core/derivative_check.h"
#include "effect_rod_problems.h"

namespace flextip {
namespace {

constexpr int kSections = 5;  // wrist, tip, three stations
constexpr double kStep = 1e-4;
constexpr int kRows = 12 * kSections + 7;

Eigen::VectorXd Outputs(const EffectRodState& state) {
  Eigen::VectorXd out(kRows);
  int row = 0;
  for (const EffectRodSection* s :
       {&state.wrist, &state.tip, &state.stations[0], &state.stations[1], &state.stations[2]}) {
    out.segment<12>(row) << s->p, s->t, s->y, s->m;
    row += 12;
  }
  out.tail<7>() << state.s_port_m, state.t_port, state.f_port;
  return out;
}

Eigen::MatrixXd Derivatives(const EffectRodState& state) {
  Eigen::MatrixXd out(kRows, rod_input::kCount);
  int row = 0;
  for (const EffectRodSection* s :
       {&state.wrist, &state.tip, &state.stations[0], &state.stations[1], &state.stations[2]}) {
    out.middleRows(row, 12) << s->dp, s->dt, s->dy, s->dm;
    row += 12;
  }
  out.bottomRows(7) << state.ds_port, state.dt_port, state.df_port;
  return out;
}

/// The size of each input that counts as 1: L, EI/L^2 and EI/L give them.
Eigen::VectorXd Units(const RodProblem& rod) {
  const double L = rod.length_m, EI = rod.bending_stiffness_Nm2;
  Eigen::VectorXd units = Eigen::VectorXd::Ones(rod_input::kCount);
  units.segment(rod_input::kWrist, 6).setConstant(L);
  units.segment(rod_input::kForce, 3).setConstant(EI / (L * L));
  units[rod_input::kLength] = L;
  units.segment(rod_input::kWeight, 3).setConstant(EI / (L * L * L));
  units.segment(rod_input::kCurvature, 2).setConstant(1.0 / L);
  units.segment(rod_input::kPortCompliance, 2).setConstant(L * L * L / EI);
  units.segment(rod_input::kPortCouple, 3).setConstant(EI / L);
  units.segment(rod_input::kInside, 3).setConstant(EI / (L * L * L));
  return units;
}

/// Outputs (rows) in the same units.
Eigen::MatrixXd Unitless(Eigen::MatrixXd J, const RodProblem& rod) {
  const double L = rod.length_m, EI = rod.bending_stiffness_Nm2;
  for (int i = 0; i < kSections; ++i) {
    J.middleRows(12 * i, 3) /= L;
    J.middleRows(12 * i + 9, 3) *= L / EI;
  }
  J.row(12 * kSections) /= L;
  J.bottomRows(3) *= L * L / EI;
  return J;
}

/// Each column by itself: its error over its size (at least one thousandth of the scale's unit).
void ExpectDerivatives(const EffectRodProblem& problem, const std::array<RodStation, 3>& stations,
                       double* worst) {
  EffectRodSolver solver;
  const EffectRodState state = solver.Solve(problem, stations);
  ASSERT_TRUE(state.IsUsable());
  const Eigen::VectorXd u0 = InputsOf(problem), units = Units(problem.rod);
  const auto f = [&](const Eigen::VectorXd& v) -> Eigen::VectorXd {
    EffectRodSolver near = solver;
    const EffectRodState moved =
        near.Solve(WithInputs(problem, u0 + units.cwiseProduct(v)), stations);
    EXPECT_TRUE(moved.IsUsable());
    return Outputs(moved);
  };
  const Eigen::VectorXd v0 = Eigen::VectorXd::Zero(rod_input::kCount);
  const Eigen::MatrixXd numeric = Unitless(NumericJacobian(f, v0, kStep), problem.rod);
  const Eigen::MatrixXd J = Unitless(Derivatives(state) * units.asDiagonal(), problem.rod);
  for (int c = 0; c < J.cols(); ++c) {
    const double error = (J.col(c) - numeric.col(c)).norm() / std::max(1e-3, numeric.col(c).norm());
    *worst = std::max(*worst, error);
    Eigen::Index row = 0;
    (J.col(c) - numeric.col(c)).cwiseAbs().maxCoeff(&row);
    EXPECT_LT(error, 1e-8) << "column " << c << ", largest at row " << row << ": " << J(row, c)
                           << " against " << numeric(row, c);
  }
}

// Stations out of order, on either side of the port, from either end.
TEST(EffectRodDerivatives, EveryOutputByEveryInput) {
  double worst = 0.0;
  for (const EffectRodProblem& problem : RandomEffectProblems(25, 11)) {
    const double L = problem.rod.length_m;
    ExpectDerivatives(problem, {{{0.15 * L, true}, {0.2 * L, false}, {0.85 * L, true}}}, &worst);
    if (HasFatalFailure()) return;
  }
  std::printf("largest error of a column: %.1e of its size\n", worst);
}

TEST(EffectRodDerivatives, WithATaper) {
  double worst = 0.0;
  for (EffectRodProblem problem : RandomEffectProblems(10, 13)) {
    const double L = problem.rod.length_m;
    for (const double taper : {-0.8, 0.5}) {
      problem.rod.stiffness_taper = taper;
      ExpectDerivatives(problem, {{{0.15 * L, true}, {0.2 * L, false}, {0.85 * L, true}}}, &worst);
      if (HasFatalFailure()) return;
    }
  }
  std::printf("largest error of a column: %.1e of its size\n", worst);
}

// Where an effect is absent its derivative is still wanted, to screen for it.
TEST(EffectRodDerivatives, AtTheRodWithoutEffects) {
  double worst = 0.0;
  for (EffectRodProblem problem : RandomEffectProblems(10, 12)) {
    const double L = problem.rod.length_m;
    const Eigen::Vector3d y = problem.effects.y_wrist;
    problem.effects = RodEffects();
    problem.effects.y_wrist = y;
    ExpectDerivatives(problem, {{{0.05 * L, false}, {0.05 * L, true}, {0.9 * L, false}}}, &worst);
    if (HasFatalFailure()) return;
  }
  std::printf("largest error of a column: %.1e of its size\n", worst);
}

}  // namespace
}  // namespace flextip
