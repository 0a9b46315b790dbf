// Faults that happen to the instrument, by the plant's own equilibria.
#include "simulation/faults/plant_faults.h"

#include <gtest/gtest.h>

namespace flextip::simulation {
namespace {

using Eigen::Vector3d;

constexpr double kStart_s = 1.0, kLasts_s = 1.0;

/// A shaft with 1 N on the tip.
PlantSetup LoadedShaft() {
  PlantSetup setup;
  setup.instrument = {.length_m = 0.6, .outer_diameter_m = 0.00238, .bending_stiffness_Nm2 = 0.304};
  setup.p_RP = {0.28, 0.0, 0.0};
  setup.load.constant_N = {0.0, -1.0, 0.0};
  return setup;
}

/// The shaft at `t_s`, stepped there in tenths of a second.
PlantShape At(double t_s, FaultKind kind, double size) {
  const PlantSetup setup = LoadedShaft();
  Plant plant(setup, {40, 40});
  PlantFaults faults({{kind, FaultStream::kPlant, kStart_s, kLasts_s, size}}, setup, 1);
  PlantShape shape = plant.Solve(Vector3d::Zero(), 0.0);
  for (int i = 1; 0.1 * i < t_s + 1e-9; ++i) {
    faults.Act(0.1 * i, shape, plant);
    shape = plant.Solve(Vector3d::Zero(), 0.1 * i);
    EXPECT_TRUE(shape.IsUsable()) << shape.message;
  }
  return shape;
}

PlantShape Healthy() { return Plant(LoadedShaft(), {40, 40}).Solve(Vector3d::Zero()); }

TEST(PlantFaults, ThePortMovesAndComesBack) {
  EXPECT_LT((At(0.9, FaultKind::kPortMoved, 0.01).p_RP - LoadedShaft().p_RP).norm(), 1e-15);
  EXPECT_NEAR((At(1.5, FaultKind::kPortMoved, 0.01).p_RP - LoadedShaft().p_RP).norm(), 0.01, 1e-12);
  EXPECT_LT((At(2.2, FaultKind::kPortMoved, 0.01).T_RE().p - Healthy().T_RE().p).norm(), 1e-7);
}

TEST(PlantFaults, TheLoadLetsGo) {
  EXPECT_NEAR(At(1.5, FaultKind::kTissueLetsGo, 0.7).f_tip_N.norm(), 0.3, 1e-9);
  // All of it: the straight shaft.
  EXPECT_NEAR(At(1.5, FaultKind::kTissueLetsGo, 1.0).T_RE().p.y(), 0.0, 1e-9);
  EXPECT_NEAR(At(2.2, FaultKind::kTissueLetsGo, 1.0).f_tip_N.norm(), 1.0, 1e-9);
}

TEST(PlantFaults, TissueLetsGoByItsStiffness) {
  PlantSetup setup = LoadedShaft();
  setup.load = {};
  setup.load.tissue = {
      .p_surface = {0.6, 0.03, 0.0}, .normal = Vector3d::UnitY(), .stiffness_N_m = 20.0};
  Plant plant(setup, {40, 40});
  PlantFaults faults({{FaultKind::kTissueLetsGo, FaultStream::kPlant, 1.0, 1.0, 1.0}}, setup, 1);
  PlantShape shape = plant.Solve(Vector3d::Zero());
  ASSERT_GT(shape.f_tip_N.norm(), 0.01);
  faults.Act(1.5, shape, plant);
  EXPECT_EQ(plant.Solve(Vector3d::Zero(), 1.5).f_tip_N.norm(), 0.0);
}

TEST(PlantFaults, WhatHoldsTheTipPullsByItsStiffness) {
  const PlantSetup setup = LoadedShaft();
  Plant plant(setup, {40, 40});
  PlantFaults faults({{FaultKind::kTipCaught, FaultStream::kPlant, kStart_s, kLasts_s, 500.0}},
                     setup, 1);
  PlantShape shape = plant.Solve(Vector3d::Zero());
  const Vector3d p_caught = shape.T_RE().p;
  faults.Act(1.1, shape, plant);
  shape = plant.Solve({0.0, 0.002, 0.0}, 1.1);
  const Vector3d pull = shape.f_tip_N - setup.load.constant_N;
  EXPECT_LT((pull - 500.0 * (p_caught - shape.T_RE().p)).norm(), 1e-9);
  EXPECT_GT(pull.norm(), 0.01);
  faults.Act(2.5, shape, plant);
  EXPECT_LT((plant.Solve({0.0, 0.002, 0.0}, 2.5).f_tip_N - setup.load.constant_N).norm(), 1e-9);
}

/// All forces on the shaft, the grasp's among them, are in balance, and it lies across.
TEST(PlantFaults, AGraspLoadsTheShaftAcross) {
  const PlantShape shape = At(1.5, FaultKind::kShaftGrasped, 2.0);
  const Vector3d rest = shape.f_port_N + shape.f_wrist_N + shape.f_tip_N;
  const double beyond_m = shape.length_m - shape.s_port_m;
  EXPECT_NEAR(rest.norm(), 2.0 * beyond_m, 1e-3);
  EXPECT_NEAR(rest.normalized().dot(shape.t_port), 0.0, 0.05);
  EXPECT_LT((At(2.2, FaultKind::kShaftGrasped, 2.0).T_RE().p - Healthy().T_RE().p).norm(), 1e-7);
}

TEST(PlantFaults, AnEncoderSlipsForGood) {
  const PlantFaults faults({{FaultKind::kEncoderSlip, FaultStream::kRobot, 1.0, 0.1, 0.004}},
                           LoadedShaft(), 1);
  EXPECT_EQ(faults.WristShift(0.9), Vector3d::Zero());
  EXPECT_NEAR(faults.WristShift(1.0).norm(), 0.004, 1e-15);
  EXPECT_EQ(faults.WristShift(99.0), faults.WristShift(1.0));
}

}  // namespace
}  // namespace flextip::simulation
