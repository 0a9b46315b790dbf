// What the plant remembers: friction that sticks and slips, backlash, dragging tissue, and the
// port's play, against what can be said by hand or by brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/draw_vector.h"
#include "simulation/plant/plant.h"

namespace flextip::simulation {
namespace {

using Eigen::Vector3d;

PlantSetup BaseSetup() {
  PlantSetup setup;
  setup.instrument = {0.6, 0.00238, 0.304, 0.0};
  setup.p_RP = {0.28, 0, 0};
  setup.load.constant_N = {0, -1.0, 0.4};
  return setup;
}

double Lateral(const PlantShape& shape) {
  return (shape.f_port_N - shape.f_port_N.dot(shape.t_port) * shape.t_port).norm();
}

TEST(PlantFriction, SlipsBothWaysAndSticksAtTheReversal) {
  PlantSetup setup = BaseSetup();
  setup.effects.port_friction.coefficient = 0.25;
  Plant plant(setup);
  double last_x = 0.0;
  const auto move = [&](double x) {
    last_x = x;
    const PlantShape shape = plant.Solve({x, 0, 0});
    EXPECT_TRUE(shape.IsUsable()) << shape.message;
    EXPECT_LE(std::abs(shape.friction_N), 0.25 * Lateral(shape) + 1e-7);
    return shape;
  };
  EXPECT_EQ(move(0).friction_N, 0.0);  // nothing has moved yet
  PlantShape shape;
  for (int i = 1; i <= 20; ++i) shape = move(0.0005 * i);  // inserted: s shrinks, pushed back
  EXPECT_TRUE(shape.slips);
  EXPECT_NEAR(shape.friction_N, -0.25 * Lateral(shape), 1e-7);
  // Balance along the straight line of wrist and port: friction is carried by the wrist.
  EXPECT_NEAR(shape.f_port_N.dot(shape.t_port), shape.friction_N, 1e-4);
  const double s_stuck = shape.s_port_m, before = shape.friction_N;
  // Back by steps of 0.2 um: the bristles give way by 1e5 N/m, friction rises evenly to the other
  // bound and stays there.
  double last = before;
  int sticking = 0;
  for (int i = 1; i <= 200; ++i) {
    shape = move(last_x - 2e-7);
    EXPECT_GE(shape.friction_N, last - 1e-7);
    last = shape.friction_N;
    if (shape.slips) break;
    ++sticking;
    EXPECT_NEAR(shape.friction_N - before, 1e5 * (shape.s_port_m - s_stuck), 1e-6);
  }
  EXPECT_GT(sticking, 10);
  ASSERT_TRUE(shape.slips);
  EXPECT_NEAR(shape.friction_N, 0.25 * Lateral(shape), 1e-7);
  shape = move(last_x - 0.01);
  EXPECT_NEAR(shape.friction_N, 0.25 * Lateral(shape), 1e-7);
}

TEST(PlantFriction, LoopTakesTheWorkOfFriction) {
  PlantSetup setup = BaseSetup();
  setup.effects.port_friction.coefficient = 0.2;
  Plant plant(setup);
  // The wrist's work along a closed loop is the friction's: the sum of |F| |ds|.
  const int n = 800;
  Vector3d f_last = Vector3d::Zero(), p_last = Vector3d::Zero();
  double s_last = 0.0, friction_last = 0.0, by_wrist = 0.0, by_friction = 0.0;
  for (int i = 0; i <= 2 * n; ++i) {
    const Vector3d p_RW(0.01 * std::sin(2 * M_PI * i / n), 0, 0.004 * std::cos(2 * M_PI * i / n));
    const PlantShape shape = plant.Solve(p_RW);
    ASSERT_TRUE(shape.IsUsable());
    if (i > n) {  // the second round is closed
      by_wrist += 0.5 * (shape.f_wrist_N + f_last).dot(p_RW - p_last);
      by_friction += 0.5 * (shape.friction_N + friction_last) * (shape.s_port_m - s_last);
    }
    f_last = shape.f_wrist_N, p_last = p_RW;
    s_last = shape.s_port_m, friction_last = shape.friction_N;
  }
  EXPECT_GT(by_friction, 0.01);  // J: about 0.4 N along 40 mm
  EXPECT_NEAR(by_wrist, by_friction, 1e-3 * by_friction);
}

TEST(PlantFriction, GripsOnlyOverItsStretch) {
  PlantSetup setup = BaseSetup();
  setup.effects.port_friction = {0.0, 0.27, 0.275, 0.8};
  Plant plant(setup);
  for (int i = 0; i <= 200; ++i) {
    const PlantShape shape = plant.Solve({0.0001 * i, 0, 0});
    ASSERT_TRUE(shape.IsUsable()) << i;
    const double s = shape.s_port_m;
    if (s > 0.2755 || s < 0.2695) {
      EXPECT_EQ(shape.friction_N, 0.0) << s;
    }
    if (s < 0.2745 && s > 0.2705) {
      EXPECT_NEAR(shape.friction_N, -0.8, 1e-9) << s;
    }
  }
}

/// Play by its definition: a peg in a slot.
struct Slot {
  double at = 0.0;
  bool begun = false;
  double Move(double x, double width) {
    if (!begun) at = x;
    begun = true;
    if (x - at > width / 2) at = x - width / 2;
    if (at - x > width / 2) at = x + width / 2;
    return at;
  }
};

TEST(PlantBacklash, IsAPlayOperatorOfEachAxis) {
  PlantSetup setup = BaseSetup();
  setup.effects.backlash_m = 0.0012;
  Plant plant(setup);
  Slot slots[3];
  std::mt19937_64 rng(7);
  std::normal_distribution<double> step(0.0, 0.0006);
  Vector3d p = Vector3d::Zero();
  for (int i = 0; i < 300; ++i) {
    p += DrawVector<3>(step, rng);
    const PlantShape shape = plant.Solve(p);
    ASSERT_TRUE(shape.IsUsable());
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(shape.T_RW().p[k], slots[k].Move(p[k], 0.0012), 1e-12);
    }
    EXPECT_EQ((shape.p_RW_measured - p).norm(), 0.0);
  }
}

TEST(PlantBacklash, AFailureLeavesTheMemoryAsItWas) {
  PlantSetup setup = BaseSetup();
  setup.effects.backlash_m = 0.002;
  setup.effects.port_friction.coefficient = 0.3;
  Plant one(setup), two(setup);
  for (Plant* plant : {&one, &two}) {
    plant->Solve({0, 0, 0});
    plant->Solve({0.01, 0.01, 0});
  }
  EXPECT_FALSE(one.Solve({-0.4, 0, 0}).IsUsable());
  const PlantShape a = one.Solve({0.009, 0.01, 0}), b = two.Solve({0.009, 0.01, 0});
  EXPECT_LT((a.T_RE().p - b.T_RE().p).norm(), 1e-9);
  EXPECT_LT((a.T_RW().p - b.T_RW().p).norm(), 1e-15);
}

TEST(PlantPlay, ShaftLiesAgainstTheRimItPushes) {
  PlantSetup setup = BaseSetup();
  setup.effects.port_play_m = 0.002;
  Plant plant(setup);
  for (int i = 0; i < 24; ++i) {
    const double angle = 2 * M_PI * i / 24;
    plant.SetLoad({{0, 1.5 * std::cos(angle), 1.5 * std::sin(angle)}, {}});
    const PlantShape shape = plant.Solve(Vector3d::Zero());
    ASSERT_TRUE(shape.IsUsable());
    const Vector3d off = shape.Position(shape.s_port_m) - shape.p_RP;
    EXPECT_NEAR(off.norm(), 0.002, 1e-6);
    EXPECT_LT((off.normalized() + shape.f_port_N.normalized()).norm(), 1e-3);
  }
}

TEST(PlantTissue, RelaxesWithItsTimeConstant) {
  PlantSetup setup = BaseSetup();
  setup.load.constant_N.setZero();
  setup.effects.shaft_tissue = {20.0, 0.5};
  Plant plant(setup);
  PlantSetup straight = BaseSetup();
  straight.load.constant_N.setZero();
  const PlantShape first = plant.Solve(Vector3d::Zero(), 0.0);
  EXPECT_LT((first.f_port_N).norm(), 1e-9);
  const Vector3d moved(0, 0.02, 0);
  // At once the tissue holds the shaft as a spring would; what is left later falls to nothing.
  double last = 1e9;
  double held[5];
  for (int i = 0; i < 5; ++i) {
    const PlantShape shape = plant.Solve(moved, 1e-9 + 0.5 * i);
    ASSERT_TRUE(shape.IsUsable());
    const PlantShape without = Plant(straight).Solve(moved);
    held[i] = (shape.Position(0.6) - without.Position(0.6)).norm();
    EXPECT_LT(held[i], last);
    last = held[i];
  }
  EXPECT_GT(held[0], 0.002);
  // The soft modes relax slower than the tissue alone, never faster.
  for (int i = 1; i < 5; ++i) {
    EXPECT_GT(held[i] / held[i - 1], std::exp(-1.0));
    EXPECT_LT(held[i] / held[i - 1], 0.75);
  }
}

TEST(PlantTissue, TinyStiffnessDragsAsABeamSays) {
  // So soft that the shaft does not mind: every place drags by -k times its own way at once.
  PlantSetup setup = BaseSetup();
  setup.load.constant_N.setZero();
  setup.effects.shaft_tissue = {1e-3, 1.0};
  Plant plant(setup);
  plant.Solve(Vector3d::Zero(), 0.0);
  const double d = 1e-3, a = 0.28, b = 0.32;
  const PlantShape shape = plant.Solve({0, d, 0}, 0.0);
  // The shaft turns about the port: beyond it the way at x is -d x / a; wrist from moments.
  const double moment = 1e-3 * d / a * b * b * b / 3;
  EXPECT_NEAR(shape.f_wrist_N.y() * a, moment, 0.02 * moment);
}

}  // namespace
}  // namespace flextip::simulation
