// The plant against closed forms, energy differences and the conventions of others.
#include "simulation/plant/plant.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "core/derivative_check.h"
#include "core/rotation.h"

namespace flextip::simulation {
namespace {

using Eigen::Vector3d;

PlantSetup BaseSetup() {
  PlantSetup setup;
  setup.instrument = {0.6, 0.00238, 0.304, 0.0};
  setup.p_RP = {0.28, 0, 0};
  return setup;
}

TEST(Plant, WithoutLoadTheShaftIsStraightThroughThePort) {
  Plant plant(BaseSetup());
  const PlantShape shape = plant.Solve({0, 0.06, -0.02});
  ASSERT_TRUE(shape.IsUsable()) << shape.message;
  const Vector3d axis = (Vector3d(0.28, 0, 0) - Vector3d(0, 0.06, -0.02)).normalized();
  EXPECT_LT((shape.Tangent(0.6) - axis).norm(), 1e-12);
  EXPECT_LT((shape.Position(0.6) - Vector3d(0, 0.06, -0.02) - 0.6 * axis).norm(), 1e-12);
  EXPECT_LT(shape.f_port_N.norm(), 1e-9);
}

TEST(Plant, SmallLoadBendsAsTheBeamOfTheTextbooks) {
  // A beam with an overhang, supports a apart, overhang b: the load's end sinks by F b^2 L / 3EI.
  PlantSetup setup = BaseSetup();
  setup.load.constant_N = {0, -1e-4, 0};
  const PlantShape shape = Plant(setup, {200, 200}).Solve(Vector3d::Zero());
  ASSERT_TRUE(shape.IsUsable());
  const double expected = 1e-4 * 0.32 * 0.32 * 0.6 / (3 * 0.304);
  EXPECT_NEAR(shape.Position(0.6).y(), -expected, 1e-4 * expected);
  EXPECT_NEAR(shape.f_port_N.y(), 1e-4 * 0.6 / 0.28, 1e-10);
  // The part beyond turns the part before toward -y, about -z: 1e-4 N at 0.2 m.
  EXPECT_NEAR(shape.Moment(0.4).z(), -1e-4 * 0.2, 1e-9);
}

TEST(Plant, ForcesBalanceAndThePortOnlyPushesSideways) {
  PlantSetup setup = BaseSetup();
  setup.weight_N_m = {0, 0, -0.3};
  setup.load.constant_N = {0.4, -1.2, 0.7};
  const PlantShape shape = Plant(setup).Solve({0.01, -0.02, 0.05});
  ASSERT_TRUE(shape.IsUsable());
  EXPECT_LT((shape.f_port_N + shape.f_wrist_N + shape.f_tip_N + 0.6 * setup.weight_N_m).norm(),
            1e-12);
  EXPECT_NEAR(shape.f_port_N.normalized().dot(shape.Tangent(shape.s_port_m)), 0.0, 1e-4);
  EXPECT_LT((shape.Position(shape.s_port_m) - setup.p_RP).norm(), 1e-12);
}

TEST(Plant, WarmAndColdAgree) {
  PlantSetup setup = BaseSetup();
  setup.load.constant_N = {0, -2, 0.5};
  Plant warm(setup);
  for (int i = 0; i < 20; ++i) {
    const Vector3d p_RW(0.004 * i, 0.003 * i, -0.002 * i);
    const PlantShape a = warm.Solve(p_RW), b = Plant(setup).Solve(p_RW);
    ASSERT_TRUE(a.IsUsable() && b.IsUsable()) << i;
    EXPECT_LT((a.Position(0.6) - b.Position(0.6)).norm(), 1e-11);
    if (i > 0) {
      EXPECT_LE(a.iterations, b.iterations);
    }
  }
}

TEST(Plant, TissuePushesWithTheForceOfItsDepth) {
  PlantSetup setup = BaseSetup();
  setup.load.tissue = Tissue{{0, -0.03, 0}, {0, 1, 0}, 150.0, 40.0, {0.6, -0.03, 0}, 2e-3};
  Plant plant(setup);
  for (double lift : {0.0, 0.02, 0.04, 0.08}) {  // raising the wrist presses the tip down
    const PlantShape shape = plant.Solve({0, lift, 0});
    ASSERT_TRUE(shape.IsUsable()) << lift;
    const Vector3d p = shape.Position(0.6);
    const double depth = -0.03 - p.y();
    const double pushed = depth <= 0 ? 0 : depth < 2e-3 ? depth * depth / 4e-3 : depth - 1e-3;
    EXPECT_NEAR(shape.f_tip_N.y(), 150.0 * pushed, 1e-9) << lift;
    const double onset = depth <= 0 ? 0 : std::min(1.0, depth / 2e-3);
    EXPECT_NEAR(shape.f_tip_N.x(), -40.0 * onset * (p.x() - 0.6), 1e-9) << lift;
  }
}

TEST(Plant, TissueStiffnessIsTheDerivativeOfItsForce) {
  TipLoad load;
  load.constant_N = {1, 2, 3};
  const Vector3d n = Vector3d(0.3, 1, -0.2).normalized();
  load.tissue = Tissue{{0.01, 0, 0}, n, 150.0, 40.0, {0.01, 0.001, 0.002}, 2e-3};
  for (double depth : {-0.001, 0.001, 0.004}) {
    const Vector3d p =
        Vector3d(0.012, 0.003, 0.004) - n * (depth + n.dot(Vector3d(0.002, 0.003, 0.004)));
    const auto f = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return load.At(x).f_N; };
    EXPECT_LT((NumericJacobian(f, p, 1e-5) - load.At(p).df_dp_N_m).norm(), 1e-6) << depth;
  }
}

TEST(Plant, FrameIsCarriedWithoutTwist) {
  PlantSetup setup = BaseSetup();
  setup.load.constant_N = {0.3, -1.5, 1.0};
  setup.weight_N_m = {0, 0.5, 0};
  setup.roll_rad = 0.7;
  const PlantShape shape = Plant(setup).Solve({0.01, 0.05, 0.03});
  ASSERT_TRUE(shape.IsUsable());
  const Eigen::Matrix3d R_W =
      RotationWithoutTwist(Vector3d::UnitX(), shape.Tangent(0)) * ExpRotation({0.7, 0, 0});
  EXPECT_LT((shape.T_RW().R - R_W).norm(), 1e-12);
  const double step = 1e-4;
  for (double s = 0.05; s < 0.58; s += 0.06) {
    const Eigen::Matrix3d R = shape.Frame(s).R;
    EXPECT_LT((R.col(0) - shape.Tangent(s)).norm(), 1e-12);
    const Vector3d spin =
        LogRotation(shape.Frame(s + step).R * shape.Frame(s - step).R.transpose());
    EXPECT_NEAR(spin.dot(R.col(0)) / (2 * step), 0.0, 2e-5) << s;  // rad/m
    // and turns as its moment says
    EXPECT_LT((spin / (2 * step) - shape.Moment(s) / 0.304).norm(), 2e-3) << s;
  }
}

TEST(Plant, SaysWhyThereIsNoShape) {
  PlantSetup setup = BaseSetup();
  EXPECT_EQ(Plant(setup).Solve({-0.4, 0, 0}).status, PlantStatus::kUnreachable);
  EXPECT_EQ(Plant(setup).Solve({0.28, 0, 0}).status, PlantStatus::kUnreachable);
  EXPECT_EQ(Plant(setup).Solve({std::nan(""), 0, 0}).status, PlantStatus::kBadInput);
  setup.load.constant_N = {0, std::numeric_limits<double>::infinity(), 0};
  EXPECT_EQ(Plant(setup).Solve(Vector3d::Zero()).status, PlantStatus::kBadInput);
  setup = BaseSetup();
  setup.instrument.bending_stiffness_Nm2 = 0;
  EXPECT_EQ(Plant(setup).Solve(Vector3d::Zero()).status, PlantStatus::kBadInput);
  setup = BaseSetup();
  setup.load.constant_N = {-1e7, -3e6, 0};
  const PlantShape shape = Plant(setup).Solve(Vector3d::Zero());
  EXPECT_EQ(shape.status, PlantStatus::kNotConverged);
  EXPECT_FALSE(shape.message.empty());
}

TEST(Plant, RecoversAfterAFailure) {
  PlantSetup setup = BaseSetup();
  setup.load.constant_N = {0, -2, 0};
  Plant plant(setup);
  const Vector3d tip = plant.Solve(Vector3d::Zero()).Position(0.6);
  EXPECT_FALSE(plant.Solve({-1, 0, 0}).IsUsable());
  const PlantShape again = plant.Solve(Vector3d::Zero());
  ASSERT_TRUE(again.IsUsable());
  EXPECT_LT((again.Position(0.6) - tip).norm(), 1e-12);
}

}  // namespace
}  // namespace flextip::simulation
