// The arm with inertia: Newton's law where it can be written by hand, energy, and friction that
// stops as Coulomb's does.
#include "simulation/arm/dynamic_arm.h"

#include <gtest/gtest.h>

#include <cmath>

namespace flextip::simulation {
namespace {

// At home the shaft lies along z: turning the second motor slides it, and all of it moves alike.
PortedShaft Shaft(double friction_N) {
  PortedShaft shaft;
  shaft.length_m = 0.32;
  shaft.mass_kg = 0.05;
  shaft.gravity_m_s2 = 0.0;
  shaft.p_port = {0.16, 0.0};
  shaft.friction_N = friction_N;
  return shaft;
}
const ArmBody kBody;
const double kSlidingMass_kg =
    kBody.inertia2_kg_m2 / (0.21 * 0.21) + kBody.wrist_mass_kg + 0.05;  // by hand, at home

double Height(const DynamicArm& arm, const PortedShaft& shaft, const Eigen::Vector2d& angles) {
  const Eigen::Vector2d wrist = arm.Wrist(angles);
  return (wrist + 0.5 * shaft.length_m * (shaft.p_port - wrist).normalized()).y();
}

TEST(DynamicArm, SlidesToAStopAsCoulombSays) {
  const DynamicArm arm(kBody, Shaft(0.4));
  constexpr double kSpeed = 0.01, kStep = 1e-5;
  ArmState state;
  state.rates[1] = kSpeed / 0.21;
  int steps = 0;
  for (; arm.SlidingRate(state.angles).dot(state.rates) < -1e-12; ++steps) {
    arm.Step(state, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), kStep);
    ASSERT_LT(steps, 100000);
  }
  EXPECT_NEAR(steps * kStep, kSlidingMass_kg * kSpeed / 0.4, 2 * kStep);
  // Semi-implicit Euler falls short by half a step at full speed.
  EXPECT_NEAR(0.16 - arm.Sliding(state.angles), kSlidingMass_kg * kSpeed * kSpeed / (2 * 0.4),
              2 * kStep * kSpeed);
}

TEST(DynamicArm, SticksBelowTheBoundAndSlipsByTheExcess) {
  const DynamicArm arm(kBody, Shaft(0.4));
  ArmState state;
  for (int i = 0; i < 1000; ++i) {
    arm.Step(state, {0.0, 0.21 * 0.399}, Eigen::Vector2d::Zero(), 1e-4);
  }
  EXPECT_LT(std::abs(state.rates[1]), 1e-15);
  EXPECT_LT(std::abs(state.angles[1]), 1e-15);
  arm.Step(state, {0.0, 0.0}, {0.5, 0.0}, 1e-4);  // the same from a force on the wrist
  EXPECT_NEAR(0.21 * state.rates[1] / 1e-4, 0.1 / kSlidingMass_kg, 1e-9);
}

TEST(DynamicArm, FrictionDoesNotHoldWhatMovesAcrossTheShaft) {
  const DynamicArm with(kBody, Shaft(5.0)), without(kBody, Shaft(0.0));
  ArmState a, b;
  with.Step(a, {0.01, 0.0}, Eigen::Vector2d::Zero(), 1e-4);
  without.Step(b, {0.01, 0.0}, Eigen::Vector2d::Zero(), 1e-4);
  EXPECT_GT(b.rates[0], 1e-5);
  EXPECT_NEAR(a.rates[0], b.rates[0], 1e-15);
}

/// What is lost is the friction times the way slid, whatever the way.
TEST(DynamicArm, FrictionTakesForceTimesWay) {
  const DynamicArm arm(kBody, Shaft(0.3));
  ArmState state{{0.2, 0.3}, {0.8, -0.5}};
  const double before = arm.KineticEnergy(state);
  double slid = 0.0, last = arm.Sliding(state.angles);
  for (int i = 0; i < 10000; ++i) {
    arm.Step(state, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), 1e-6);
    slid += std::abs(arm.Sliding(state.angles) - last);
    last = arm.Sliding(state.angles);
  }
  const double lost = before - arm.KineticEnergy(state);
  EXPECT_GT(lost, 0.2 * before);
  EXPECT_NEAR(lost, 0.3 * slid, 1e-4 * before);
}

/// Falling freely, energy is kept, the better the shorter the step.
TEST(DynamicArm, KeepsItsEnergyWithoutFriction) {
  PortedShaft shaft = Shaft(0.0);
  shaft.gravity_m_s2 = 9.81;
  const DynamicArm arm(kBody, shaft);
  const auto drift = [&](double step_s) {
    ArmState state{{0.1, -0.1}, {1.0, -2.0}};
    const auto energy = [&] {
      return arm.KineticEnergy(state) + shaft.mass_kg * 9.81 * Height(arm, shaft, state.angles);
    };
    const double before = energy();
    for (int i = 0; i < std::lround(0.1 / step_s); ++i) {
      arm.Step(state, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), step_s);
    }
    EXPECT_GT((state.angles - Eigen::Vector2d(0.1, -0.1)).norm(), 0.05);
    return std::abs(energy() - before) / before;
  };
  EXPECT_LT(drift(1e-5), 2e-4);
  EXPECT_NEAR(drift(2e-5) / drift(1e-5), 2.0, 0.1);
}

/// The torque that gravity takes is its potential's slope.
TEST(DynamicArm, GravityTorqueIsTheSlopeOfTheHeight) {
  PortedShaft shaft = Shaft(0.0);
  shaft.gravity_m_s2 = 9.81;
  const DynamicArm arm(kBody, shaft);
  const Eigen::Vector2d at(0.15, 0.35);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d step = 1e-6 * Eigen::Vector2d::Unit(i);
    const double slope = (Height(arm, shaft, at + step) - Height(arm, shaft, at - step)) / 2e-6;
    EXPECT_NEAR(arm.GravityTorque(at)[i], 0.05 * 9.81 * slope, 1e-9);
  }
}

TEST(JointPid, AnswersEachPartOfTheError) {
  JointPid pid({2.0, 3.0, 0.5}, {0.1, 0.0});
  const Eigen::Vector2d error(0.01, 0.0), rates(0.0, 0.2);
  const Eigen::Vector2d torque = pid.Torque(error, rates, 1e-3);
  EXPECT_DOUBLE_EQ(torque[0], 2.0 * 0.01 + 0.1 + 3.0 * 0.01 * 1e-3);
  EXPECT_DOUBLE_EQ(torque[1], -0.5 * 0.2);
  EXPECT_DOUBLE_EQ(pid.Torque(Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), 1e-3)[0],
                   0.1 + 3.0 * 0.01 * 1e-3);
}

}  // namespace
}  // namespace flextip::simulation
