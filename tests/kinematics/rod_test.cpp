#include "kinematics/rod.h"

#include <gtest/gtest.h>

#include <random>

#include "core/derivative_check.h"
#include "core/draw_vector.h"
#include "rod_reference.h"

namespace flextip {
namespace {

/// Largest error over the table, kept with its row.
struct Worst {
  double value = 0.0;
  std::size_t row = 0;
  void Add(double v, std::size_t i) {
    if (!(v <= value)) value = v, row = i;
  }
};

TEST(RodReference, EveryRowFromAColdStart) {
  const auto rows = ReadRodReference();
  ASSERT_EQ(rows.size(), 150u);
  Worst tip, tangent, force, moment, place;
  int iterations = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ReferenceRow& row = rows[i];
    RodSolver solver;
    const RodState state = solver.Solve(Problem(row));
    ASSERT_EQ(state.status, RodStatus::kOk) << "row " << i + 2;
    iterations = std::max(iterations, state.iterations);
    tip.Add((state.tip.p - Vector(row, "p_tip_m")).norm(), i);
    tangent.Add((state.tip.t - Vector(row, "t_tip")).norm(), i);
    tangent.Add((state.wrist.t - Vector(row, "t_wrist")).norm(), i);
    place.Add(std::abs(state.s_port_m - row.at("s_port_m")), i);
    // Relative to the largest force and moment of the row: the least of them may nearly vanish.
    const Eigen::Vector3d f_port = Vector(row, "f_port_on_shaft_N");
    force.Add((state.f_port - f_port).norm() / f_port.norm(), i);
    const Eigen::Vector3d f_wrist = Vector(row, "f_wrist_on_shaft_N");
    force.Add((state.f_wrist - f_wrist).norm() / f_wrist.norm(), i);
    const double s = row.at("s_port_m"), L = row.at("length_m");
    const Eigen::Vector3d m1 = Vector(row, "m_at_half_wrist_segment_Nm");
    const Eigen::Vector3d m2 = Vector(row, "m_at_half_tip_segment_Nm");
    moment.Add((solver.Section(0.5 * s).m - m1).norm() / m1.norm(), i);
    moment.Add((solver.Section(0.5 * (s + L)).m - m2).norm() / m2.norm(), i);
  }
  std::printf(
      "tip %.1e m, tangents %.1e, s_port %.1e m, forces %.1e, moments %.1e, %d evaluations\n",
      tip.value, tangent.value, place.value, force.value, moment.value, iterations);
  EXPECT_LT(tip.value, 1e-8) << "row " << tip.row + 2;
  EXPECT_LT(tangent.value, 1e-7) << "row " << tangent.row + 2;
  EXPECT_LT(place.value, 1e-8) << "row " << place.row + 2;
  EXPECT_LT(force.value, 1e-6) << "row " << force.row + 2;
  EXPECT_LT(moment.value, 1e-6) << "row " << moment.row + 2;
}

RodProblem Moved(RodProblem problem, const Eigen::VectorXd& x) {
  problem.p_wrist = x.segment<3>(0);
  problem.p_port = x.segment<3>(3);
  problem.f_tip = x.segment<3>(6);
  return problem;
}

Eigen::VectorXd Parameters(const RodProblem& problem) {
  Eigen::VectorXd x(9);
  x << problem.p_wrist, problem.p_port, problem.f_tip;
  return x;
}

/// Problems away from the edges by construction: 3-D loads, with self-weight and without.
std::vector<RodProblem> RandomProblems(int count, unsigned seed = 7) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto vector = [&] { return DrawVector<3>(uniform, rng); };
  std::vector<RodProblem> problems;
  for (int i = 0; i < count; ++i) {
    RodProblem p;
    p.length_m = 0.45 + 0.15 * uniform(rng);
    p.bending_stiffness_Nm2 = 0.4 + 0.3 * uniform(rng);
    p.p_wrist = 0.1 * vector();
    const Eigen::Vector3d along = vector().normalized();
    p.p_port = p.p_wrist + p.length_m * (0.5 + 0.25 * uniform(rng)) * along;
    const double unit = p.bending_stiffness_Nm2 / (p.length_m * p.length_m);
    p.f_tip = 1.5 * unit * vector();
    if (i % 2 == 1) p.q_weight = 0.5 * unit / p.length_m * vector();
    problems.push_back(p);
  }
  return problems;
}

TEST(RodDerivatives, TipWristAndSectionsAgainstDifferences) {
  for (const RodProblem& problem : RandomProblems(20)) {
    RodSolver solver;
    const RodState state = solver.Solve(problem);
    ASSERT_TRUE(state.IsUsable());
    const double L = problem.length_m;
    // One place on either side of the port, away from it: at the port itself the moment has a kink.
    for (const double s : {0.0, 0.5 * state.s_port_m, 0.5 * (state.s_port_m + L), L}) {
      const RodSection section = solver.Section(s);
      const auto f = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        RodSolver other;
        EXPECT_TRUE(other.Solve(Moved(problem, x)).IsUsable());
        const RodSection at = other.Section(s);
        Eigen::VectorXd y(9);
        y << at.p, at.t, at.m;
        return y;
      };
      Eigen::MatrixXd J(9, 9);
      J << section.dp, section.dt, section.dm;
      const Eigen::MatrixXd numeric = NumericJacobian(f, Parameters(problem), 1e-4);
      EXPECT_LT((J - numeric).norm(), 1e-7 * numeric.norm()) << "s = " << s << "\n" << J - numeric;
    }
    const auto port_tangent = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
      return RodSolver().Solve(Moved(problem, x)).t_port;
    };
    const Eigen::MatrixXd numeric = NumericJacobian(port_tangent, Parameters(problem), 1e-4);
    EXPECT_LT((state.dt_port - numeric).norm(), 1e-7 * numeric.norm());
    EXPECT_LT((solver.Section(0.0).p - problem.p_wrist).norm(), 1e-11);
    EXPECT_LT((solver.Section(state.s_port_m).p - problem.p_port).norm(), 1e-11);
  }
}

// The shaft begins at the wrist. The derivatives are those of the last iterate, whose conditions
// hold to 1e-9 of the length; how much more they miss depends on the load. (4e-10 at most of 1200.)
TEST(RodDerivatives, TheFirstSectionMovesWithTheWrist) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const RodProblem& problem : RandomProblems(20, seed)) {
      RodSolver solver;
      ASSERT_TRUE(solver.Solve(problem).IsUsable());
      const Eigen::Matrix3d moved = solver.Section(0.0).dp.leftCols<3>();
      EXPECT_LT((moved - Eigen::Matrix3d::Identity()).norm(), 1e-8) << seed;
    }
  }
}

TEST(RodDerivatives, TissueStiffnessAgainstDifferences) {
  for (const RodProblem& problem : RandomProblems(10)) {
    Eigen::Matrix3d K;  // pushes back along one direction more than along the others
    K << -120, 10, 5, 10, -60, 0, 5, 0, -30;
    RodSolver solver;
    const RodState state = solver.Solve(problem);
    ASSERT_TRUE(state.IsUsable());
    const Eigen::Vector3d p_rest = state.tip.p;
    const auto tip = [&](const Eigen::VectorXd& wrist) -> Eigen::VectorXd {
      // Fixed-point of p = tip(f + K (p - p_rest)) by Newton with a difference-free secant: the
      // compliance of the unperturbed state.
      RodProblem p = problem;
      p.p_wrist = wrist;
      RodSolver other;
      Eigen::Vector3d f = problem.f_tip;
      for (int i = 0; i < 100; ++i) {
        p.f_tip = f;
        const Eigen::Vector3d reached = other.Solve(p).tip.p;
        const Eigen::Vector3d miss = problem.f_tip + K * (reached - p_rest) - f;
        if (miss.norm() < 1e-13) break;
        f += (Eigen::Matrix3d::Identity() - K * state.tip.dp.rightCols<3>()).inverse() * miss;
      }
      return other.Solve(p).tip.p;
    };
    const Eigen::MatrixXd numeric = NumericJacobian(tip, problem.p_wrist, 1e-4);
    EXPECT_LT((state.J_tip_wrist(K) - numeric).norm(), 1e-6 * numeric.norm());
  }
}

TEST(Rod, ForcesAndMomentsBalance) {
  for (const RodProblem& problem : RandomProblems(30)) {
    RodSolver solver;
    const RodState state = solver.Solve(problem);
    ASSERT_TRUE(state.IsUsable());
    EXPECT_LT(std::abs(state.f_port.dot(state.t_port)), 1e-11 * problem.f_tip.norm());
    EXPECT_LT(state.wrist.m.norm(), 1e-11);
    // Moments about the wrist of port, tip and weight (its line of action by Simpson's rule).
    Eigen::Vector3d weight = Eigen::Vector3d::Zero();
    const int n = 200;
    for (int i = 0; i <= n; ++i) {
      const double w = (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) / (3.0 * n) * problem.length_m;
      weight +=
          w *
          (solver.Section(problem.length_m * i / n).p - problem.p_wrist).cross(problem.q_weight);
    }
    const Eigen::Vector3d moment = (problem.p_port - problem.p_wrist).cross(state.f_port) +
                                   (state.tip.p - problem.p_wrist).cross(problem.f_tip) + weight;
    EXPECT_LT(moment.norm(), 1e-8);
  }
}

TEST(Rod, WarmStartAgreesWithCold) {
  for (RodProblem problem : RandomProblems(20)) {
    RodSolver warm;
    ASSERT_TRUE(warm.Solve(problem).IsUsable());
    for (int i = 0; i < 20; ++i) {
      problem.p_wrist += 0.002 * Eigen::Vector3d(1, -0.5, 0.3);
      problem.f_tip *= 1.02;
      RodSolver cold;
      const RodState a = warm.Solve(problem), b = cold.Solve(problem);
      ASSERT_EQ(a.status, b.status);
      if (!a.IsUsable()) break;
      EXPECT_LT((a.tip.p - b.tip.p).norm(), 1e-11);
      EXPECT_LE(a.iterations, 4);
    }
  }
}

/// Changes as a loop, a fit and a user make them, from none at all to another instrument.
const std::pair<const char*, void (*)(RodProblem&)> kChanges[] = {
    {"nothing", [](RodProblem&) {}},
    {"wrist and port together",
     [](RodProblem& p) {
       const Eigen::Vector3d shift(0.03, -0.02, 0.01);
       p.p_wrist += shift, p.p_port += shift;
     }},
    {"a rounding", [](RodProblem& p) { p.p_wrist.x() += 1e-16, p.f_tip.y() += 1e-17; }},
    {"a nanometre", [](RodProblem& p) { p.p_wrist.y() += 1e-9; }},
    {"length", [](RodProblem& p) { p.length_m *= 1.01; }},
    {"stiffness", [](RodProblem& p) { p.bending_stiffness_Nm2 *= 1.1; }},
    {"weight",
     [](RodProblem& p) {
       p.q_weight = {0.1, 0.2, -0.3};
     }},
    {"wrist", [](RodProblem& p) { p.p_wrist += Eigen::Vector3d(0.004, 0.002, -0.003); }},
    {"the same way back", [](RodProblem& p) { p.p_wrist -= Eigen::Vector3d(4e-3, 2e-3, -3e-3); }},
    {"a load let go", [](RodProblem& p) { p.f_tip.setZero(); }},
    {"a load taken up",
     [](RodProblem& p) {
       p.f_tip = {0.2, -0.9, 0.4};
     }},
    {"a load turned round", [](RodProblem& p) { p.f_tip *= -1.0; }},
};

TEST(Rod, WarmStartAgreesWithColdAfterAnyChange) {
  for (const RodProblem& start : RandomProblems(20)) {
    for (const auto& [name, change] : kChanges) {
      SCOPED_TRACE(name);
      RodSolver warm;
      RodProblem problem = start;
      ASSERT_TRUE(warm.Solve(problem).IsUsable());
      change(problem);
      const RodState a = warm.Solve(problem), b = RodSolver().Solve(problem);
      ASSERT_EQ(a.status, b.status);
      if (!a.IsUsable()) continue;
      EXPECT_LT((a.tip.p - b.tip.p).norm(), 1e-11);
      EXPECT_LT((a.tip.dp - b.tip.dp).norm(), 1e-8 * b.tip.dp.norm());
      EXPECT_LT((a.wrist.dt - b.wrist.dt).norm(), 1e-8 * b.wrist.dt.norm());
      EXPECT_LT((a.f_port - b.f_port).norm(), 1e-9 * (1.0 + b.f_port.norm()));
    }
  }
}

TEST(Rod, UnloadedShaftIsStraight) {
  RodProblem problem{0.5, 0.3, {0, 0, 0}, {0.2, 0.1, 0.0}, {0, 0, 0}, {0, 0, 0}};
  const RodState state = RodSolver().Solve(problem);
  ASSERT_TRUE(state.IsUsable());
  EXPECT_LT((state.tip.p - 0.5 * problem.p_port.normalized()).norm(), 1e-14);
  EXPECT_NEAR(state.s_port_m, problem.p_port.norm(), 1e-14);
}

TEST(Rod, SaysWhatItCannotSolve) {
  const RodProblem good{0.5, 0.3, {0, 0, 0}, {0.25, 0, 0}, {0, 0.5, 0}, {0, 0, 0}};
  RodSolver solver;
  const auto status = [&](auto change) {
    RodProblem problem = good;
    change(problem);
    const RodState state = solver.Solve(problem);
    EXPECT_TRUE(state.tip.p.allFinite() && state.tip.dp.allFinite());
    return state.status;
  };
  EXPECT_EQ(status([](RodProblem&) {}), RodStatus::kOk);
  EXPECT_EQ(status([](RodProblem& p) { p.length_m = 0; }), RodStatus::kBadInput);
  EXPECT_EQ(status([](RodProblem& p) { p.f_tip.x() = NAN; }), RodStatus::kBadInput);
  EXPECT_EQ(status([](RodProblem& p) { p.bending_stiffness_Nm2 = -1; }), RodStatus::kBadInput);
  EXPECT_EQ(status([](RodProblem& p) { p.p_port.x() = 0.6; }), RodStatus::kUnreachable);
  EXPECT_EQ(status([](RodProblem& p) { p.p_port = p.p_wrist; }), RodStatus::kUnreachable);
  EXPECT_EQ(status([](RodProblem& p) { p.f_tip.y() = 1e6; }), RodStatus::kNotConverged);
  // And a failure leaves nothing behind that would spoil the next solve.
  EXPECT_EQ(status([](RodProblem&) {}), RodStatus::kOk);
}

}  // namespace
}  // namespace flextip
