// The rod with effects against closed forms and against the laws of statics, which know nothing of
// how it is solved.
#include <gtest/gtest.h>

#include <array>

#include "core/rotation.h"
#include "effect_rod_problems.h"

namespace flextip {
namespace {

/// Sections at any number of places.
std::vector<EffectRodSection> Sections(EffectRodSolver& solver, const EffectRodProblem& problem,
                                       const std::vector<double>& places) {
  std::vector<EffectRodSection> sections;
  for (const double s : places) {
    const std::array<RodStation, 1> station{{{s, false}}};
    const EffectRodState state = solver.Solve(problem, station);
    EXPECT_TRUE(state.IsUsable());
    sections.push_back(state.stations[0]);
  }
  return sections;
}

// Without load the shaft keeps its unloaded curvature: an arc through wrist and port.
TEST(EffectRodPhysics, PrecurvedUnloadedShaftIsAnArc) {
  EffectRodProblem problem;
  problem.rod = {0.5, 0.3, {0.1, 0.0, -0.1}, {0.25, 0.1, 0.05}, {0, 0, 0}, {0, 0, 0}};
  problem.effects.y_wrist = {0.3, 1.0, 0.2};
  problem.effects.curvature_1_m = {1.1, -0.7};
  problem.effects.port_compliance_m_N = 1e-3;  // there is no force to yield to
  problem.effects.port_friction = 0.5;
  const double kappa = problem.effects.curvature_1_m.norm();
  const Eigen::Vector3d chord = problem.rod.p_port - problem.rod.p_wrist;
  const std::array<RodStation, 2> stations{{{0.1, false}, {0.1, true}}};
  const EffectRodState state = EffectRodSolver().Solve(problem, stations);
  ASSERT_TRUE(state.IsUsable());
  EXPECT_LT(state.f_port.norm(), 2e-6);  // friction fades out at a force of this size
  EXPECT_NEAR(state.s_port_m, 2 / kappa * std::asin(0.5 * kappa * chord.norm()), 1e-7);
  const Eigen::Vector3d t0 = state.wrist.t, normal = t0.cross(chord).normalized();
  EXPECT_NEAR(normal.dot(state.wrist.y), problem.effects.curvature_1_m.x() / kappa, 1e-6);
  EXPECT_NEAR(normal.dot(t0.cross(state.wrist.y)), problem.effects.curvature_1_m.y() / kappa, 1e-6);
  for (const EffectRodSection* section :
       {&state.wrist, &state.tip, &state.stations[0], &state.stations[1]}) {
    const double s = section->s_m;
    const Eigen::Vector3d p = problem.rod.p_wrist + std::sin(kappa * s) / kappa * t0 +
                              (1 - std::cos(kappa * s)) / kappa * normal.cross(t0);
    EXPECT_LT((section->p - p).norm(), 1e-7);
    EXPECT_LT((section->t - ExpRotation(kappa * s * normal) * t0).norm(), 1e-6);
    EXPECT_LT((section->y - ExpRotation(kappa * s * normal) * state.wrist.y).norm(), 1e-6);
    EXPECT_LT(section->m.norm(), 1e-6);
  }
}

// Linear beam theory: pinned at 0, spring, couple and force at a, force and load beyond it.
TEST(EffectRodPhysics, SmallDeflectionsFollowTheBeam) {
  const double L = 0.5, EI = 0.3, a = 0.3, b = L - a, F = 2e-4, q = 5e-4;
  const double spring = 0.8, c = 2e-3, c_wrist = 1e-3;
  EffectRodProblem problem;
  problem.rod = {L, EI, {0, 0, 0}, {a, 0, 0}, {0, F, 0}, {0, 0, 0}};
  problem.effects.y_wrist = {0, 0, 1};
  problem.effects.port_compliance_m_N = c;
  problem.effects.wrist_compliance_m_N = c_wrist;
  problem.effects.port_couple_Nm = {spring, 0, 0};
  problem.effects.q_inside_N_m = {0, q, 0};
  const EffectRodState state = EffectRodSolver().Solve(problem);
  ASSERT_TRUE(state.IsUsable());
  // M on the wrist's side of the port = M_beyond - spring x slope; slope = flexibility x M + tilt.
  const double N = F + q * b, M_beyond = F * b + 0.5 * q * b * b;
  const double flexibility = a / (3 * EI) + (c + c_wrist) / (a * a), tilt = c * N / a;
  const double M = (M_beyond - spring * tilt) / (1 + spring * flexibility);
  const double slope = flexibility * M + tilt, r = -N - M / a;
  const double tip = -c * r + slope * b + F * b * b * b / (3 * EI) + q * std::pow(b, 4) / (8 * EI);
  EXPECT_NEAR(state.t_port.y(), slope, 1e-6 * slope);
  EXPECT_NEAR(state.f_port.y(), r, 1e-6 * std::abs(r));
  EXPECT_NEAR(state.wrist.p.y(), -c_wrist * M / a, 1e-6 * c_wrist * M / a);
  EXPECT_NEAR(state.tip.p.y(), tip, 1e-6 * tip);
  EXPECT_NEAR(state.s_port_m, a, 1e-6);
}

/// Composite Gauss quadrature of (p - origin) ds between two places.
Eigen::Vector3d MeanWay(EffectRodSolver& solver, const EffectRodProblem& problem, double from,
                        double to, const Eigen::Vector3d& origin) {
  const int panels = 8;
  const double h = (to - from) / panels, node = std::sqrt(0.6);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < panels; ++i) {
    const double mid = from + (i + 0.5) * h;
    const auto at = Sections(solver, problem, {mid - 0.5 * h * node, mid, mid + 0.5 * h * node});
    sum += h / 18.0 * (5.0 * at[0].p + 8.0 * at[1].p + 5.0 * at[2].p - 18.0 * origin);
  }
  return sum;
}

TEST(EffectRodPhysics, ForcesAndMomentsOfTheWholeShaftBalance) {
  for (const EffectRodProblem& problem : RandomEffectProblems(15, 21)) {
    const RodProblem& rod = problem.rod;
    const RodEffects& effects = problem.effects;
    EffectRodSolver solver;
    const EffectRodState state = solver.Solve(problem);
    ASSERT_TRUE(state.IsUsable());
    const double L = rod.length_m, unit = rod.bending_stiffness_Nm2 / (L * L);
    const Eigen::Vector3d force = state.f_wrist + state.f_port + rod.f_tip + L * rod.q_weight +
                                  (L - state.s_port_m) * effects.q_inside_N_m;
    EXPECT_LT(force.norm(), 1e-10 * unit);
    // The wrist holds the torsion moment; it and the port's couple have no lever.
    const Eigen::Vector3d o = state.wrist.p;
    const Eigen::Vector3d p_port = Sections(solver, problem, {state.s_port_m})[0].p;
    const Eigen::Vector3d before = MeanWay(solver, problem, 0.0, state.s_port_m, o),
                          beyond = MeanWay(solver, problem, state.s_port_m, L, o);
    const Eigen::Vector3d moment =
        (p_port - o).cross(state.f_port) + state.t_port.cross(effects.port_couple_Nm) +
        (state.tip.p - o).cross(rod.f_tip) + (before + beyond).cross(rod.q_weight) +
        beyond.cross(effects.q_inside_N_m) - state.wrist.m;
    EXPECT_LT(moment.norm(), 1e-9 * unit * L);
    EXPECT_LT(state.wrist.m.cross(state.wrist.t).norm(), 1e-12 * unit * L);
    // Port and arm yield as they should, and friction is in its ratio.
    const double along = state.f_port.dot(state.t_port);
    const Eigen::Vector3d lateral = state.f_port - along * state.t_port;
    EXPECT_LT((p_port - rod.p_port + effects.port_compliance_m_N * lateral).norm(), 1e-10 * L);
    EXPECT_LT((o - rod.p_wrist + effects.wrist_compliance_m_N * state.f_wrist).norm(), 1e-10 * L);
    EXPECT_NEAR(along, effects.port_friction * lateral.norm(), 1e-9 * unit);
  }
}

// Kirchhoff's equations by differences between neighbouring sections, on both sides of the port.
TEST(EffectRodPhysics, SectionsObeyTheDifferentialEquations) {
  for (const EffectRodProblem& problem : RandomEffectProblems(15, 22)) {
    const RodProblem& rod = problem.rod;
    const double L = rod.length_m, EI = rod.bending_stiffness_Nm2, h = 1e-3 * L;
    EffectRodSolver solver;
    const EffectRodState state = solver.Solve(problem);
    ASSERT_TRUE(state.IsUsable());
    for (const double s : {0.4 * state.s_port_m, 0.5 * (state.s_port_m + L)}) {
      const auto at = Sections(solver, problem, {s - 2 * h, s - h, s, s + h, s + 2 * h});
      const auto rate = [&](auto member) -> Eigen::Vector3d {
        return (8.0 * (at[3].*member - at[1].*member) - (at[4].*member - at[0].*member)) / (12 * h);
      };
      const bool beyond = s > state.s_port_m;
      const Eigen::Vector3d t = at[2].t, y = at[2].y, z = t.cross(y);
      EXPECT_NEAR(t.norm(), 1.0, 1e-14);
      EXPECT_NEAR(y.norm(), 1.0, 1e-14);
      EXPECT_NEAR(t.dot(y), 0.0, 1e-14);
      const Eigen::Vector3d K = at[2].m / EI + problem.effects.curvature_1_m.x() * y +
                                problem.effects.curvature_1_m.y() * z;
      Eigen::Vector3d n = rod.f_tip + (L - s) * rod.q_weight +
                          (L - std::max(s, state.s_port_m)) * problem.effects.q_inside_N_m;
      if (!beyond) n += state.f_port;
      EXPECT_LT((rate(&EffectRodSection::p) - t).norm(), 1e-9);
      EXPECT_LT((rate(&EffectRodSection::t) - K.cross(t)).norm() * L, 1e-8);
      EXPECT_LT((rate(&EffectRodSection::y) - K.cross(y)).norm() * L, 1e-8);
      EXPECT_LT((rate(&EffectRodSection::m) - n.cross(t)).norm() * L * L / EI, 1e-8);
    }
    // Across the port the moment jumps by its couple.
    const double tiny = 1e-9 * L;
    const auto at = Sections(solver, problem, {state.s_port_m - tiny, state.s_port_m + tiny});
    const Eigen::Vector3d couple = state.t_port.cross(problem.effects.port_couple_Nm);
    EXPECT_LT((at[0].m - at[1].m - couple).norm() * L / EI, 1e-7);
  }
}

// In a plane, and without curvature in space, the section's axes do not twist: a moment about the
// normal of the plane stays in the same local components.
TEST(EffectRodPhysics, AxesGoAlongWithoutTwist) {
  EffectRodProblem problem;
  problem.rod = {0.5, 0.3, {0, 0, 0}, {0.25, 0, 0}, {0.2, 1.0, 0}, {0, -0.3, 0}};
  problem.effects.y_wrist = {0.1, 0.6, 0.8};
  problem.effects.port_couple_Nm = {0.1, 0.05, 0};
  problem.effects.port_friction = 0.2;
  const std::array<RodStation, 2> stations{{{0.1, false}, {0.1, true}}};
  const EffectRodState state = EffectRodSolver().Solve(problem, stations);
  ASSERT_TRUE(state.IsUsable());
  const EffectRodSection& wrist = state.wrist;
  for (const EffectRodSection* section : {&state.stations[0], &state.stations[1], &state.tip}) {
    const Eigen::Matrix3d R = RotationWithoutTwist(wrist.t, section->t);
    EXPECT_LT((section->y - R * wrist.y).norm(), 1e-11);
    EXPECT_NEAR(section->m.x(), 0.0, 1e-11);
    EXPECT_NEAR(section->m.y(), 0.0, 1e-11);
    EXPECT_NEAR(section->m.dot(section->y), section->m.z() * wrist.y.z(), 1e-11);
    EXPECT_NEAR(section->m.dot(section->t.cross(section->y)),
                section->m.z() * wrist.t.cross(wrist.y).z(), 1e-11);
  }
  for (EffectRodProblem spatial : RandomEffectProblems(10, 23)) {
    spatial.effects.curvature_1_m.setZero();
    EffectRodSolver solver;
    const double L = spatial.rod.length_m, s = 0.9 * L, h = 1e-3 * L;
    const auto at = Sections(solver, spatial, {s - h, s, s + h});
    const double twist = (at[2].y - at[0].y).dot(at[1].t.cross(at[1].y)) / (2 * h);
    EXPECT_LT(std::abs(twist) * L, 1e-6);
    EXPECT_LT(std::abs(at[1].m.dot(at[1].t)) * L / spatial.rod.bending_stiffness_Nm2, 1e-11);
  }
}

}  // namespace
}  // namespace flextip
