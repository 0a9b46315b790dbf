// The plant with many effects at once against the exact rod with effects of kinematics/, another
// method by another hand. Only this test brings the two together.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "kinematics/effect_rod.h"
#include "simulation/plant/plant.h"

namespace flextip::simulation {
namespace {

using Eigen::Vector3d;
using Outputs = Eigen::Matrix<double, 22, 1>;

struct Case {
  PlantSetup setup;
  Vector3d p_RW, p_RW_before;  // the shaft slides from the one to the other
};

class Draw {
 public:
  explicit Draw(unsigned seed) : rng_(seed) {}
  double In(double a, double b) { return std::uniform_real_distribution<double>(a, b)(rng_); }
  Vector3d Around(double size) { return {In(-size, size), In(-size, size), In(-size, size)}; }

 private:
  std::mt19937_64 rng_;
};

/// Everything of both models, at sizes beyond what a recording would hold; or `only` one of them.
Case RandomCase(Draw& draw, int only = -1) {
  Case problem;
  PlantSetup& setup = problem.setup;
  setup.instrument = {0.6, 0.00238, 0.304, 0.0};
  setup.p_RP = {0.28, 0, 0};
  setup.weight_N_m = {0, 0, -0.3};
  setup.load.constant_N = draw.Around(1.5);
  setup.roll_rad = draw.In(-3, 3);
  setup.torsion = 1.0;  // as the rod has it
  problem.p_RW = draw.Around(0.05);
  PlantEffects all;
  all.stiffness_scale = draw.In(0.7, 1.3);
  all.length_delta_m = draw.In(-0.02, 0.02);
  all.mass_per_length_kg_m = draw.In(0, 0.06);
  all.curvature_1_m = {draw.In(-0.4, 0.4), draw.In(-0.4, 0.4)};
  all.port_offset_m = draw.Around(0.01);
  all.port_compliance_m_N = draw.In(0, 2e-3);
  all.port_friction.coefficient = draw.In(0.05, 0.4);
  all.port_stiffness_Nm_rad = draw.In(0, 0.3);
  all.port_rest_axis = (Vector3d::UnitX() + draw.Around(0.5)).normalized();
  all.shaft_load_N_m = draw.Around(1.5);
  all.wrist_compliance_m_N = draw.In(0, 1e-3);
  const double way = draw.In(0, 1) < 0.5 ? -0.02 : 0.02;
  problem.p_RW_before = problem.p_RW + Vector3d(way, 0, 0);
  PlantEffects& effects = setup.effects;
  if (only < 0) effects = all;
  if (only == 0) effects.stiffness_scale = all.stiffness_scale;
  if (only == 1) effects.length_delta_m = all.length_delta_m;
  if (only == 2) effects.mass_per_length_kg_m = all.mass_per_length_kg_m;
  if (only == 3) effects.curvature_1_m = all.curvature_1_m;
  if (only == 4) effects.port_offset_m = all.port_offset_m;
  if (only == 5) effects.port_compliance_m_N = all.port_compliance_m_N;
  if (only == 6) effects.port_friction = all.port_friction;
  if (only == 7) effects.port_stiffness_Nm_rad = all.port_stiffness_Nm_rad;
  effects.port_rest_axis = all.port_rest_axis;
  if (only == 8) effects.shaft_load_N_m = all.shaft_load_N_m;
  if (only == 9) effects.wrist_compliance_m_N = all.wrist_compliance_m_N;
  return problem;
}

constexpr std::array<const char*, 10> kEffects = {
    "stiffness",       "length",        "mass",        "precurvature", "port offset",
    "port compliance", "port friction", "port moment", "shaft load",   "wrist compliance"};

PlantShape SolvePlant(const Case& problem, int links) {
  Plant plant(problem.setup, {links / 2, links / 2});
  plant.Solve(problem.p_RW_before);
  return plant.Solve(problem.p_RW);
}

/// Lengths over L, directions, forces in N, moments in Nm.
Outputs OutputsOf(const PlantShape& shape) {
  Outputs out;
  const double length = shape.length_m;
  out << shape.Position(length) / length, shape.Tangent(length), shape.Tangent(0),
      shape.T_RW().p / length, shape.f_port_N, shape.s_port_m / length,
      shape.Moment(0.5 * shape.s_port_m), shape.T_RE().R.col(1);
  return out;
}

Outputs Extrapolated(const Case& problem) {
  return (4.0 * OutputsOf(SolvePlant(problem, 400)) - OutputsOf(SolvePlant(problem, 200))) / 3.0;
}

EffectRodState SolveRod(const Case& problem, const PlantShape& shape) {
  const PlantEffects& effects = problem.setup.effects;
  EffectRodProblem rod;
  rod.rod.length_m = problem.setup.instrument.length_m + effects.length_delta_m;
  rod.rod.bending_stiffness_Nm2 =
      problem.setup.instrument.bending_stiffness_Nm2 * effects.stiffness_scale;
  rod.rod.p_wrist = problem.p_RW;
  rod.rod.p_port = problem.setup.p_RP + effects.port_offset_m;
  rod.rod.f_tip = problem.setup.load.constant_N;
  rod.rod.q_weight =
      problem.setup.weight_N_m + effects.mass_per_length_kg_m * Vector3d(0, 0, -9.81);
  rod.effects.y_wrist = shape.T_RW().R.col(1);
  rod.effects.curvature_1_m = effects.curvature_1_m;
  rod.effects.port_compliance_m_N = effects.port_compliance_m_N;
  rod.effects.wrist_compliance_m_N = effects.wrist_compliance_m_N;
  rod.effects.q_inside_N_m = effects.shaft_load_N_m;
  // The rod's hinge has the couple of the angle's sine, the plant's that of the angle.
  const double sine = shape.t_port.cross(effects.port_rest_axis).norm();
  rod.effects.port_couple_Nm =
      effects.port_stiffness_Nm_rad * std::asin(sine) / sine * effects.port_rest_axis;
  rod.effects.port_friction = std::copysign(effects.port_friction.coefficient, shape.friction_N);
  const RodStation station{0.5 * shape.s_port_m, false};
  return EffectRodSolver().Solve(rod, {&station, 1});
}

Outputs OutputsOf(const EffectRodState& rod, double length) {
  Outputs out;
  out << rod.tip.p / length, rod.tip.t, rod.wrist.t, rod.wrist.p / length, rod.f_port,
      rod.s_port_m / length, rod.stations[0].m, rod.tip.y;
  return out;
}

double WorstDifference(const Case& problem) {
  const PlantShape shape = SolvePlant(problem, 400);
  EXPECT_TRUE(shape.IsUsable()) << shape.message;
  const EffectRodState rod = SolveRod(problem, shape);
  EXPECT_TRUE(rod.IsUsable()) << Name(rod.status);
  if (!shape.IsUsable() || !rod.IsUsable()) return 1.0;
  if (problem.setup.effects.port_friction.coefficient > 0) {
    EXPECT_TRUE(shape.slips);
  }
  const Outputs difference = Extrapolated(problem) - OutputsOf(rod, shape.length_m);
  return difference.cwiseAbs().maxCoeff();
}

TEST(PlantAgainstRod, EachEffectAlone) {
  Draw draw(1);
  for (int effect = 0; effect < static_cast<int>(kEffects.size()); ++effect) {
    double worst = 0.0;
    for (int i = 0; i < 10; ++i) worst = std::max(worst, WorstDifference(RandomCase(draw, effect)));
    std::printf("%-17s %.2e\n", kEffects[effect], worst);
    EXPECT_LT(worst, 2e-6) << kEffects[effect];
  }
}

TEST(PlantAgainstRod, AllEffectsTogether) {
  Draw draw(2);
  double worst = 0.0;
  for (int i = 0; i < 40; ++i) worst = std::max(worst, WorstDifference(RandomCase(draw)));
  std::printf("all effects       %.2e\n", worst);
  EXPECT_LT(worst, 5e-6);
}

}  // namespace
}  // namespace flextip::simulation
