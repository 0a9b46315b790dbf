#include "kinematics/effect_rod.h"

#include <gtest/gtest.h>

#include "effect_rod_problems.h"
#include "rod_reference.h"
#include "tests/control/allocation_counter.h"

namespace flextip {
namespace {

/// An axis of the section that is well across the shaft.
Eigen::Vector3d AxisAcross(const RodProblem& rod) {
  Eigen::Index least = 0;
  (rod.p_port - rod.p_wrist).cwiseAbs().minCoeff(&least);
  return Eigen::Vector3d::Unit(least);
}

TEST(EffectRod, WithoutEffectsEqualsTheReferenceTable) {
  const auto rows = ReadRodReference();
  ASSERT_EQ(rows.size(), 150u);
  double tip = 0.0, tangent = 0.0, place = 0.0, force = 0.0, moment = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ReferenceRow& row = rows[i];
    EffectRodProblem problem;
    problem.rod = Problem(row);
    problem.effects.y_wrist = AxisAcross(problem.rod);
    const double s = row.at("s_port_m"), L = row.at("length_m");
    const std::array<RodStation, 2> stations{{{0.5 * (L - s), true}, {0.5 * s, false}}};
    const EffectRodState state = EffectRodSolver().Solve(problem, stations);
    ASSERT_EQ(state.status, RodStatus::kOk) << "row " << i + 2;
    const auto far = [&](double& worst, const Eigen::Vector3d& v, const std::string& name,
                         double unit) {
      worst = std::max(worst, (v - Vector(row, name)).norm() / unit);
    };
    far(tip, state.tip.p, "p_tip_m", 1.0);
    far(tangent, state.tip.t, "t_tip", 1.0);
    far(tangent, state.wrist.t, "t_wrist", 1.0);
    far(force, state.f_port, "f_port_on_shaft_N", Vector(row, "f_port_on_shaft_N").norm());
    far(force, state.f_wrist, "f_wrist_on_shaft_N", Vector(row, "f_wrist_on_shaft_N").norm());
    for (const auto& [k, name] :
         {std::pair{1, "m_at_half_wrist_segment_Nm"}, std::pair{0, "m_at_half_tip_segment_Nm"}}) {
      far(moment, state.stations[k].m, name, Vector(row, name).norm());
    }
    place = std::max(place, std::abs(state.s_port_m - s));
  }
  std::printf("tip %.1e m, tangents %.1e, s_port %.1e m, forces %.1e, moments %.1e\n", tip, tangent,
              place, force, moment);
  EXPECT_LT(tip, 1e-8);
  EXPECT_LT(tangent, 1e-7);
  EXPECT_LT(place, 1e-8);
  EXPECT_LT(force, 1e-6);
  EXPECT_LT(moment, 1e-6);
}

TEST(EffectRod, WithoutEffectsEqualsTheRod) {
  double state_error = 0.0, derivative_error = 0.0;
  for (EffectRodProblem problem : RandomEffectProblems(40, 3)) {
    problem.effects = RodEffects();
    problem.effects.y_wrist = AxisAcross(problem.rod);
    const double L = problem.rod.length_m, unit = problem.rod.bending_stiffness_Nm2 / L;
    const std::array<RodStation, 2> stations{{{0.9 * L, false}, {0.1 * L, false}}};
    RodSolver rod_solver;
    const RodState rod = rod_solver.Solve(problem.rod);
    const EffectRodState state = EffectRodSolver().Solve(problem, stations);
    ASSERT_TRUE(rod.IsUsable() && state.IsUsable());
    const auto compare = [&](const EffectRodSection& a, const RodSection& b) {
      state_error = std::max(
          {state_error, (a.p - b.p).norm() / L, (a.t - b.t).norm(), (a.m - b.m).norm() / unit});
      const double p = (a.dp.leftCols<9>() - b.dp).norm() / b.dp.norm();
      const double t = (a.dt.leftCols<9>() - b.dt).norm() / b.dt.norm();
      derivative_error = std::max(
          {derivative_error, p, t, (a.dm.leftCols<9>() - b.dm).norm() / (unit * b.dt.norm())});
    };
    compare(state.tip, rod.tip);
    compare(state.wrist, rod.wrist);
    compare(state.stations[0], rod_solver.Section(0.9 * L));
    compare(state.stations[1], rod_solver.Section(0.1 * L));
    EXPECT_LT((state.dt_port.leftCols<9>() - rod.dt_port).norm(), 1e-8 * rod.dt_port.norm());
  }
  std::printf("states %.1e, derivatives %.1e\n", state_error, derivative_error);
  EXPECT_LT(state_error, 1e-10);
  EXPECT_LT(derivative_error, 1e-8);
}

TEST(EffectRod, WarmStartAgreesWithCold) {
  int most = 0;
  for (EffectRodProblem problem : RandomEffectProblems(20, 4)) {
    EffectRodSolver warm;
    ASSERT_TRUE(warm.Solve(problem).IsUsable());
    for (int i = 0; i < 10; ++i) {
      problem.rod.p_wrist += 0.002 * Eigen::Vector3d(1, -0.5, 0.3);
      problem.rod.f_tip *= 1.02;
      problem.effects.port_friction -= 0.01;
      problem.effects.curvature_1_m *= 0.98;
      const EffectRodState a = warm.Solve(problem), b = EffectRodSolver().Solve(problem);
      ASSERT_EQ(a.status, b.status);
      if (!a.IsUsable()) break;
      EXPECT_LT((a.tip.p - b.tip.p).norm(), 1e-10 * problem.rod.length_m);
      most = std::max(most, a.iterations);
    }
  }
  EXPECT_LE(most, 4);
}

TEST(EffectRod, SaysWhatItCannotSolve) {
  EffectRodProblem good;
  good.rod = {0.5, 0.3, {0, 0, 0}, {0.25, 0, 0}, {0, 0.5, 0}, {0, 0, 0}};
  good.effects.curvature_1_m = {0.2, -0.1};
  EffectRodSolver solver;
  std::vector<RodStation> stations{{0.1, false}, {0.1, true}};
  const auto status = [&](auto change) {
    EffectRodProblem problem = good;
    change(problem);
    const EffectRodState state = solver.Solve(problem, stations);
    EXPECT_TRUE(state.tip.p.allFinite() && state.tip.dp.allFinite() && state.df_port.allFinite());
    return state.status;
  };
  using P = EffectRodProblem;
  const double nan = std::nan("");
  EXPECT_EQ(status([](P&) {}), RodStatus::kOk);
  EXPECT_EQ(status([](P& p) { p.rod.length_m = 0; }), RodStatus::kBadInput);
  EXPECT_EQ(status([](P& p) { p.rod.bending_stiffness_Nm2 = -1; }), RodStatus::kBadInput);
  EXPECT_EQ(status([&](P& p) { p.rod.f_tip.x() = nan; }), RodStatus::kBadInput);
  EXPECT_EQ(status([&](P& p) { p.effects.port_friction = nan; }), RodStatus::kBadInput);
  EXPECT_EQ(status([&](P& p) { p.effects.q_inside_N_m.z() = INFINITY; }), RodStatus::kBadInput);
  EXPECT_EQ(status([&](P& p) { p.effects.y_wrist.y() = nan; }), RodStatus::kBadInput);
  EXPECT_EQ(status([](P& p) { p.effects.y_wrist.setZero(); }), RodStatus::kBadInput);
  EXPECT_EQ(status([](P& p) { p.effects.y_wrist = {-2, 0, 0}; }), RodStatus::kBadInput);
  EXPECT_EQ(status([](P& p) { p.rod.p_port.x() = 0.6; }), RodStatus::kUnreachable);
  EXPECT_EQ(status([](P& p) { p.rod.p_port = p.rod.p_wrist; }), RodStatus::kUnreachable);
  EXPECT_EQ(status([](P& p) { p.rod.f_tip.y() = 1e6; }), RodStatus::kNotConverged);
  EXPECT_EQ(status([](P& p) { p.effects.curvature_1_m.x() = 1e5; }), RodStatus::kNotConverged);
  for (const RodStation bad : {RodStation{0.5, false}, RodStation{0.0, true},
                               RodStation{-0.1, false}, RodStation{nan, false}}) {
    stations = {bad};
    EXPECT_EQ(status([](P&) {}), RodStatus::kBadInput);
  }
  stations.assign(kMaxRodStations + 1, {0.1, false});
  EXPECT_EQ(status([](P&) {}), RodStatus::kBadInput);
  // And a failure leaves nothing behind that would spoil the next solve.
  stations.assign(kMaxRodStations, {0.1, false});
  EXPECT_EQ(status([](P&) {}), RodStatus::kOk);
}

TEST(EffectRod, AllocatesNothing) {
  const std::vector<EffectRodProblem> problems = RandomEffectProblems(5, 6);
  EffectRodSolver solver;
  bool ok = true;
  const long before = AllocationCount();
  for (const EffectRodProblem& problem : problems) {
    const std::array<RodStation, 2> stations{{{0.1, false}, {0.1, true}}};
    ok &= solver.Solve(problem, stations).IsUsable();
    ok &= solver.Solve(problem, stations).IsUsable();
    solver.Reset();
  }
  EXPECT_EQ(AllocationCount(), before);
  EXPECT_TRUE(ok);
}

}  // namespace
}  // namespace flextip
