// Each effect of the plant against what can be said by hand: beams of the textbooks, balances,
// exact curves, operators by brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "core/derivative_check.h"
#include "core/draw_vector.h"
#include "core/rotation.h"
#include "simulation/plant/chain.h"
#include "simulation/plant/plant.h"

namespace flextip::simulation {
namespace {

using Eigen::Vector3d;

constexpr double kEi = 0.304, kLength = 0.6, kPort = 0.28;

PlantSetup BaseSetup() {
  PlantSetup setup;
  setup.instrument = {kLength, 0.00238, kEi, 0.0};
  setup.p_RP = {kPort, 0, 0};
  return setup;
}

PlantShape SolveOne(const PlantSetup& setup, const Vector3d& p_RW = Vector3d::Zero(),
                    double t_s = 0.0, int links = 100) {
  const PlantShape shape = Plant(setup, {links, links}).Solve(p_RW, t_s);
  EXPECT_TRUE(shape.IsUsable()) << shape.message;
  return shape;
}

TEST(PlantEffects, SmallDeflectionsAreThoseOfBeams) {
  // Supports a apart, overhang b, force F at the end: F b^2 (a + b) / 3 EI; yielding supports tilt
  // and shift the whole beam by their own deflections F L / a and F b / a times compliance.
  const double a = kPort, b = kLength - kPort, F = 1e-4;
  const auto deflection = [&](const std::function<void(PlantEffects&)>& set) {
    PlantSetup setup = BaseSetup();
    setup.load.constant_N = {0, -F, 0};
    set(setup.effects);
    return -SolveOne(setup, Vector3d::Zero(), 0.0, 200).T_RE().p.y();
  };
  const double plain = F * b * b * kLength / (3 * kEi), c = 2e-3;
  EXPECT_NEAR(deflection([](PlantEffects& e) { e.stiffness_scale = 0.5; }), 2 * plain,
              1e-4 * plain);
  EXPECT_NEAR(deflection([&](PlantEffects& e) { e.port_compliance_m_N = c; }),
              plain + c * F * kLength * kLength / (a * a), 1e-4 * plain);
  EXPECT_NEAR(deflection([&](PlantEffects& e) { e.wrist_compliance_m_N = c; }),
              plain + c * F * b * b / (a * a), 1e-4 * plain);
  EXPECT_NEAR(deflection([&](PlantEffects& e) { e.tip_compliance_m_N = c; }), plain + c * F,
              1e-4 * plain);
  // Spring k at the port: the slope there is F a b / (3 EI + k a), the overhang adds F b^3 / 3 EI.
  const double k = 0.8;
  EXPECT_NEAR(deflection([&](PlantEffects& e) { e.port_stiffness_Nm_rad = k; }),
              F * a * b * b / (3 * kEi + k * a) + F * b * b * b / (3 * kEi), 1e-4 * plain);
}

TEST(PlantEffects, LoadsOnTheShaftAreThoseOfBeams) {
  const double a = kPort, b = kLength - kPort, w = 1e-4;
  PlantSetup setup = BaseSetup();
  setup.effects.shaft_load_N_m = {0, w, 0};
  // On the overhang: slope at the port w b^2 a / 6 EI, its own end w b^4 / 8 EI.
  const double expected = w * b * b * a / (6 * kEi) * b + w * std::pow(b, 4) / (8 * kEi);
  EXPECT_NEAR(SolveOne(setup).Position(kLength).y(), expected, 1e-4 * expected);
  EXPECT_NEAR(SolveOne(setup).f_port_N.y(), -w * b * (a + 0.5 * b) / a, 1e-9);
  setup.effects = {};
  setup.effects.mass_per_length_kg_m = w / 9.81;
  setup.gravity_m_s2 = {0, 9.81, 0};
  // On the whole: the span bends back, w a^3 / 24 EI of slope.
  const double all = expected - w * a * a * a / (24 * kEi) * b;
  EXPECT_NEAR(SolveOne(setup).Position(kLength).y(), all, 1e-4 * std::abs(expected));
}

TEST(PlantEffects, TaperBendsAsItsIntegralSays) {
  const double a = kPort, F = 1e-4, taper = 0.5;
  PlantSetup setup = BaseSetup();
  setup.load.constant_N = {0, -F, 0};
  setup.effects.taper = taper;
  // Unit load theorem: the integral of m^2 / (F EI(s)) for the moment m of the end's force.
  double expected = 0.0;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double s = kLength * (i + 0.5) / n;
    const double m = s < a ? (kLength - a) * s / a : kLength - s;
    expected += F * m * m / (kEi * (1 + taper * (1 - 2 * s / kLength))) * kLength / n;
  }
  EXPECT_NEAR(-SolveOne(setup, Vector3d::Zero(), 0.0, 200).Position(kLength).y(), expected,
              1e-4 * expected);
}

TEST(PlantEffects, UnloadedBentShaftIsAnArcThroughThePort) {
  PlantSetup setup = BaseSetup();
  setup.effects.curvature_1_m = {0.6, -0.8};  // 1 1/m
  setup.roll_rad = 0.4;
  const PlantShape shape = SolveOne(setup, {0.01, 0.02, -0.03});
  EXPECT_LT(shape.f_port_N.norm(), 1e-7);
  EXPECT_LT((shape.Position(shape.s_port_m) - setup.p_RP).norm(), 1e-12);
  // The turn about the wrist's own axes, y and z by the two numbers.
  const Eigen::Matrix3d R_W = shape.T_RW().R;
  const Vector3d axis = R_W * Vector3d(0, 0.6, -0.8);
  for (double s : {0.1, 0.3, 0.6}) {
    EXPECT_LT((shape.Tangent(s) - ExpRotation(s * axis) * R_W.col(0)).norm(), 2e-5) << s;
    EXPECT_LT((shape.Frame(s).R.col(1) - ExpRotation(s * axis) * R_W.col(1)).norm(), 2e-5) << s;
    EXPECT_LT(shape.Moment(s).norm(), 1e-6) << s;
  }
  const double chord = 2 * std::sin(0.3);  // of the arc of 0.6 rad, radius 1 m
  EXPECT_NEAR((shape.Position(kLength) - shape.Position(0)).norm(), chord, 1e-5);
}

PlantEffects ManyEffects() {
  PlantEffects effects;
  effects.stiffness_scale = 0.9;
  effects.length_delta_m = 0.004;
  effects.mass_per_length_kg_m = 0.02;
  effects.curvature_1_m = {0.3, -0.2};
  effects.port_offset_m = {0.003, -0.002, 0.004};
  effects.port_compliance_m_N = 8e-4;
  effects.port_friction.coefficient = 0.2;
  effects.port_stiffness_Nm_rad = 0.15;
  effects.port_rest_axis = Vector3d(1, 0.2, -0.3).normalized();
  effects.shaft_load_N_m = {0.3, -0.6, 0.8};
  effects.wrist_compliance_m_N = 4e-4;
  effects.tip_compliance_m_N = 3e-4;
  effects.taper = 0.2;
  effects.second_contact = {0.06, {0.5, -0.02, 0}, Vector3d(0.1, 1, 0.2), 300.0};
  return effects;
}

PlantSetup ManySetup() {
  PlantSetup setup = BaseSetup();
  setup.effects = ManyEffects();
  setup.load.constant_N = {0.3, -1.1, 0.6};
  setup.weight_N_m = {0, 0, -0.2};
  setup.roll_rad = 0.5;
  return setup;
}

struct Sums {
  Vector3d force, moment;
};

/// What acts on the shaft from outside, about the true wrist; the arm's torsion moment with it.
Sums Balance(const PlantSetup& setup, const PlantShape& shape) {
  const PlantEffects& effects = setup.effects;
  const double length = shape.length_m;
  const Vector3d origin = shape.T_RW().p;
  const Vector3d weight = setup.weight_N_m + effects.mass_per_length_kg_m * setup.gravity_m_s2;
  Sums sums{shape.f_port_N + shape.f_wrist_N + shape.f_tip_N + shape.f_contact_N,
            shape.port_couple_Nm - shape.Moment(0)};
  const auto at = [&](double s) -> Vector3d { return shape.Position(s) - origin; };
  sums.moment += at(shape.s_port_m).cross(shape.f_port_N) + at(length).cross(shape.f_tip_N) +
                 at(length - effects.second_contact.s_from_tip_m).cross(shape.f_contact_N);
  const int n = 4000;
  for (int i = 0; i < n; ++i) {
    const double s = length * (i + 0.5) / n;
    Vector3d q = weight;
    if (s > shape.s_port_m) q += effects.shaft_load_N_m;
    sums.force += length / n * q;
    sums.moment += length / n * at(s).cross(q);
  }
  return sums;
}

TEST(PlantEffects, AllTogetherBalanceAndKeepTheirLaws) {
  const PlantSetup setup = ManySetup();
  const PlantEffects& effects = setup.effects;
  Plant plant(setup, {200, 200});
  plant.Solve({0.0, 0.02, 0.01});
  const PlantShape shape = plant.Solve({-0.03, 0.02, 0.01});
  ASSERT_TRUE(shape.IsUsable()) << shape.message;
  const Sums sums = Balance(setup, shape);
  EXPECT_LT(sums.force.norm(), 1e-3);   // of some N: the port is within a cell of the sum above
  EXPECT_LT(sums.moment.norm(), 2e-4);  // of some 0.5 Nm
  // Every law by what the shape says.
  const Vector3d lateral = shape.f_port_N - shape.f_port_N.dot(shape.t_port) * shape.t_port;
  EXPECT_TRUE(shape.slips);
  EXPECT_NEAR(shape.friction_N, 0.2 * lateral.norm(), 1e-7);  // drawn out: held back, toward +t
  EXPECT_NEAR(shape.f_port_N.dot(shape.t_port), shape.friction_N, 1e-3);
  EXPECT_LT((shape.p_RP - setup.p_RP - effects.port_offset_m + 8e-4 * lateral).norm(), 1e-9);
  EXPECT_LT((shape.Position(shape.s_port_m) - shape.p_RP).norm(), 1e-9);
  EXPECT_LT((shape.T_RW().p - shape.p_RW_measured + 4e-4 * shape.f_wrist_N).norm(), 1e-9);
  EXPECT_LT((shape.T_RE().p - shape.Position(shape.length_m) - 3e-4 * shape.f_tip_N).norm(), 1e-12);
  const double angle = std::acos(shape.t_port.dot(effects.port_rest_axis));
  EXPECT_NEAR(shape.port_couple_Nm.norm(), 0.15 * angle, 1e-5);
  const Vector3d n = effects.second_contact.normal.normalized();
  const double depth =
      n.dot(effects.second_contact.p_surface - shape.Position(shape.length_m - 0.06));
  const double pushed = depth <= 0 ? 0 : depth < 1e-3 ? depth * depth / 2e-3 : depth - 5e-4;
  EXPECT_GT(depth, 1e-3);
  EXPECT_NEAR(shape.f_contact_N.dot(n), 300 * pushed, 300 * 2e-6);
}

TEST(PlantEffects, AllTogetherConvergeWithSecondOrder) {
  PlantSetup setup = ManySetup();
  setup.effects.second_contact = {};  // a force inside a link wanders with it
  Eigen::Matrix<double, 9, 1> found[4];
  for (int k = 0; k < 4; ++k) {
    Plant plant(setup, {25 << k, 25 << k});
    plant.Solve({0.0, 0.02, 0.01});
    const PlantShape shape = plant.Solve({-0.03, 0.02, 0.01});
    ASSERT_TRUE(shape.IsUsable());
    found[k] << shape.T_RE().p, shape.T_RE().R.col(1), 0.1 * shape.f_port_N;
  }
  const double ratio = (found[2] - found[1]).norm() / (found[3] - found[2]).norm();
  std::printf("many effects: change of 0.1 N, m, 1 as links double: %.2e %.2e %.2e\n",
              (found[1] - found[0]).norm(), (found[2] - found[1]).norm(),
              (found[3] - found[2]).norm());
  EXPECT_GT(ratio, 3.9);
  EXPECT_LT(ratio, 4.1);
}

TEST(PlantEffects, NeutralEffectsAreNone) {
  PlantSetup setup = BaseSetup();
  setup.load.constant_N = {0.4, -1.2, 0.7};
  const PlantShape plain = SolveOne(setup);
  setup.effects.port_rest_axis = {0, 1, 0};
  setup.effects.port_motion = {{0, 0, 0}, 0.3, 1.0, 0.4};
  setup.effects.port_friction.grip_to_m = 0.3;
  setup.effects.second_contact.s_from_tip_m = 0.1;
  const PlantShape neutral = SolveOne(setup, Vector3d::Zero(), 2.0);
  EXPECT_EQ((plain.T_RE().p - neutral.T_RE().p).norm(), 0.0);
  EXPECT_EQ((plain.f_port_N - neutral.f_port_N).norm(), 0.0);
}

TEST(PlantEffects, HingeAndYieldHaveTheDerivativesTheyState) {
  ChainProblem problem;
  problem.n1 = 7, problem.n2 = 5;
  problem.port = {0.1, 0.02, 0.3, 0.7, Vector3d(1, 0.4, -0.2).normalized()};
  ChainState state;
  std::mt19937_64 rng(4);
  std::uniform_real_distribution<double> draw(-0.2, 0.2);
  for (int j = 0; j < 12; ++j) {
    const Eigen::Vector2d across = DrawVector<2>(draw, rng);
    state.u.push_back(Vector3d(1, across.x(), across.y()).normalized());
  }
  state.s = 0.55;
  const Vector3d t = state.u[0];
  const auto yield = [&](const Eigen::VectorXd& r) -> Eigen::VectorXd {
    return YieldOf(problem.port, r, t).shaft;
  };
  const Vector3d r(0.3, -0.2, 0.5);
  EXPECT_LT((NumericJacobian(yield, r, 1e-5) - YieldOf(problem.port, r, t).dshaft_dr).norm(), 1e-8);
  // The energy of the spring in series with its lag, as a function of the link before the port.
  const auto energy = [&](const ChainState& at) {
    const ChainGeometry geometry(problem, at.s);
    const double h1 = geometry.h(6), h2 = geometry.h(7);
    const Vector3d v = (h2 * at.u[6] + h1 * at.u[7]) / (h1 + h2);
    const double angle = std::acos(v.normalized().dot(problem.port.rest_axis));
    return 0.5 * 0.7 / (1 + 0.7 * h1 * h2 / (2 * (h1 + h2))) * angle * angle;
  };
  const PortHinge hinge = HingeOf(problem, ChainGeometry(problem, state.s), state);
  for (int k = 0; k < 3; ++k) {
    ChainState more = state, less = state;
    more.u[6] += 1e-6 * Vector3d::Unit(k);
    less.u[6] -= 1e-6 * Vector3d::Unit(k);
    EXPECT_NEAR(hinge.before * hinge.gradient[k], (energy(more) - energy(less)) / 2e-6, 1e-8);
    const auto gradient = [&](const ChainState& at) {
      return HingeOf(problem, ChainGeometry(problem, at.s), at).gradient;
    };
    EXPECT_LT(
        (hinge.before * hinge.hessian.col(k) - (gradient(more) - gradient(less)) / 2e-6).norm(),
        1e-8);
  }
  ChainState more = state, less = state;
  more.s += 1e-6;
  less.s -= 1e-6;
  EXPECT_NEAR(hinge.ds, (energy(more) - energy(less)) / 2e-6, 1e-8);
}

TEST(PlantEffects, BreathingMovesThePortWithItsPeriod) {
  PlantSetup setup = BaseSetup();
  setup.effects.port_motion = {{0.001, 0.003, -0.002}, 0.25, 0.6, 0.15};
  Plant plant(setup);
  double highest = -1e9, lowest = 1e9, mean = 0.0;
  for (int i = 0; i < 200; ++i) {
    const double t = 0.02 * i;
    const PlantShape now = plant.Solve(Vector3d::Zero(), t),
                     later = plant.Solve(Vector3d::Zero(), t + 4);
    ASSERT_TRUE(now.IsUsable() && later.IsUsable());
    EXPECT_LT((now.p_RP - later.p_RP).norm(), 1e-12);
    EXPECT_LT((now.Position(now.s_port_m) - now.p_RP).norm(), 1e-12);
    const double w = (now.p_RP - setup.p_RP).y() / 0.003;
    EXPECT_NEAR((now.p_RP - setup.p_RP).z(), -0.002 * w, 1e-15);
    highest = std::max(highest, w);
    lowest = std::min(lowest, w);
    mean += w / 200;
  }
  EXPECT_NEAR(highest, 1.15, 1e-3);  // sharper at the top
  EXPECT_NEAR(lowest, -0.85, 1e-3);
  EXPECT_NEAR(mean, 0.0, 1e-12);
}

TEST(PlantEffects, BadEffectsAreRefused) {
  const auto status = [](const std::function<void(PlantEffects&)>& set) {
    PlantSetup setup = BaseSetup();
    set(setup.effects);
    return Plant(setup).Solve(Vector3d::Zero()).status;
  };
  EXPECT_EQ(status([](PlantEffects& e) { e.stiffness_scale = 0; }), PlantStatus::kBadInput);
  EXPECT_EQ(status([](PlantEffects& e) { e.length_delta_m = -0.6; }), PlantStatus::kBadInput);
  EXPECT_EQ(status([](PlantEffects& e) { e.length_delta_m = -0.33; }), PlantStatus::kUnreachable);
  EXPECT_EQ(status([](PlantEffects& e) { e.taper = 1; }), PlantStatus::kBadInput);
  EXPECT_EQ(status([](PlantEffects& e) { e.backlash_m = -1e-4; }), PlantStatus::kBadInput);
  EXPECT_EQ(status([](PlantEffects& e) { e.curvature_1_m.x() = std::nan(""); }),
            PlantStatus::kBadInput);
}

}  // namespace
}  // namespace flextip::simulation
