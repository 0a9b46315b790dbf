// The silicone's force law: its derivative, what it does to a tip that is pushed and dragged, and
// that the plant finds its equilibria in it.
#include "simulation/tissue/soft_cylinder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/draw_vector.h"
#include "simulation/plant/plant.h"

namespace flextip::simulation {
namespace {

using Eigen::Vector3d;

constexpr double kDiameter_m = 0.00238;

SoftCylinderSetup GelSetup(double scale = 1.0) {
  SoftCylinderSetup setup = SiliconeOf(Silicone(), kDiameter_m, scale);
  setup.p_surface = {0.74, 0.0, 0.0};
  return setup;
}

/// Pushes straight in to `depth`.
void PushTo(SoftCylinder& silicone, double depth, double y = 0.0) {
  for (int i = 1; i <= 100; ++i) silicone.MoveTo({0.74 + depth * i / 100, y, 0.0});
}

/// Drags along y and returns the last force.
Vector3d Drag(SoftCylinder& silicone, double depth, double from, double to) {
  constexpr int kSteps = 600;
  Vector3d force = Vector3d::Zero();
  for (int i = 1; i <= kSteps; ++i) {
    const Vector3d p(0.74 + depth, from + (to - from) * i / kSteps, 0.0);
    force = silicone.At(p).f_N;
    silicone.MoveTo(p);
  }
  return force;
}

TEST(SoftCylinder, DerivativeMatchesDifferences) {
  SoftCylinder silicone(GelSetup());
  PushTo(silicone, 0.006);
  Drag(silicone, 0.006, 0.0, 0.006);
  std::mt19937_64 rng(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int torn = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d at = DrawVector<3>(uniform, rng);
    const Vector3d p(0.745 + 0.006 * at.x(), 0.01 * at.y(), 0.012 * at.z());
    const LinearTipForce force = silicone.At(p);
    for (int k = 0; k < 3; ++k) {
      const double h = 1e-7;
      const Vector3d slope = (silicone.At(p + h * Vector3d::Unit(k)).f_N -
                              silicone.At(p - h * Vector3d::Unit(k)).f_N) /
                             (2.0 * h);
      // The law has kinks in its slope: differences there are off by the kink's size times h.
      EXPECT_LT((slope - force.df_dp_N_m.col(k)).norm(), 2e-3) << i << " " << k;
    }
    torn += force.f_N.tail<2>().norm() > 0.9 * 0.042 * (p.x() - 0.74);
  }
  EXPECT_GT(torn, 20);
}

TEST(SoftCylinder, PushesLikeAnElasticFootThenPunctures) {
  SoftCylinder silicone(GelSetup());
  // 2 a E / (1 - nu^2) for a rigid flat foot on a half space.
  const double stiffness = kDiameter_m * 3400.0 / (1.0 - 0.49 * 0.49);
  PushTo(silicone, 0.003);
  const double force = -silicone.At({0.743, 0, 0}).f_N.x();
  EXPECT_NEAR(force, stiffness * (0.003 - 0.5 * 5e-4 - 0.5 * 5e-4), 0.3e-3 * stiffness);
  EXPECT_EQ(silicone.CutDepth({0.743, 0, 0}), 0.0);  // elastic: no damage
  EXPECT_EQ(silicone.At({0.7399, 0, 0}).f_N, Vector3d::Zero());
  // Far in, the force stays at the puncture's and the way back is without it.
  const double puncture = GelSetup().puncture_N;
  PushTo(silicone, 0.05);
  EXPECT_NEAR(-silicone.At({0.79, 0, 0}).f_N.x(), puncture, 1e-12);
  EXPECT_GT(silicone.CutDepth({0.79, 0, 0}), 0.0);
  EXPECT_EQ(silicone.At({0.75, 0, 0}).f_N.x(), 0.0);
}

TEST(SoftCylinder, DragsAtItsTearingForceWhateverTheSpeed) {
  const double expected = 0.006 - 0.5 * 5e-4;  // depth less the onset
  for (const double step : {1e-5, 1e-4}) {
    SoftCylinder silicone(GelSetup());
    PushTo(silicone, 0.006);
    Vector3d force = Vector3d::Zero();
    for (double y = 0.0; y < 0.02; y += step) {
      force = silicone.At({0.746, y, 0.0}).f_N;
      silicone.MoveTo({0.746, y, 0.0});
    }
    EXPECT_NEAR(force.y(), -GelSetup().ploughing_N_m * expected, 1e-6);
    EXPECT_NEAR(force.z(), 0.0, 1e-12);
  }
}

TEST(SoftCylinder, SmallMovesLoseNothingAndLargeOnesDo) {
  for (const double size : {0.004, 0.02}) {
    SoftCylinder silicone(GelSetup());
    PushTo(silicone, 0.006);
    const double dy = size / 400;
    double work = 0.0;  // done on the silicone, out and back
    double y = 0.0;
    for (const double direction : {1.0, -1.0}) {
      for (int i = 0; i < 400; ++i) {
        const Vector3d p(0.746, y + 0.5 * direction * dy, 0.0);
        work -= silicone.At(p).f_N.y() * direction * dy;
        y += direction * dy;
        silicone.MoveTo({0.746, y, 0.0});
      }
    }
    if (size < 0.005) {
      EXPECT_NEAR(work, 0.0, 1e-12);
      EXPECT_EQ(silicone.CutPart(0.02), 0.0);
    } else {
      EXPECT_GT(work, 1e-3);
      EXPECT_GT(silicone.CutPart(0.02), 0.01);
    }
  }
}

TEST(SoftCylinder, IsWeakerWhereItWasCut) {
  SoftCylinder silicone(GelSetup());
  PushTo(silicone, 0.006);
  const double first = -Drag(silicone, 0.006, 0.0, 0.02).y();
  Drag(silicone, 0.006, 0.02, 0.0);
  const double again = -Drag(silicone, 0.006, 0.0, 0.015).y();
  EXPECT_NEAR(again / first, GelSetup().ploughing_when_cut_N_m / GelSetup().ploughing_N_m, 0.02);
  // Deeper than the cut only that part of it is weaker.
  SoftCylinder shallow(GelSetup());
  PushTo(shallow, 0.003);
  Drag(shallow, 0.003, 0.0, 0.02);
  shallow.MoveTo({0.73, 0.0, 0.0});
  PushTo(shallow, 0.006);
  const double deeper = -Drag(shallow, 0.006, 0.0, 0.015).y();
  EXPECT_GT(deeper, 1.2 * again);
  EXPECT_LT(deeper, 0.95 * first);
}

TEST(SoftCylinder, ScaleMultipliesAllForces) {
  SoftCylinder one(GelSetup()), two(GelSetup(2.0));
  for (SoftCylinder* silicone : {&one, &two}) PushTo(*silicone, 0.006);
  for (const double y : {0.002, 0.01, 0.015}) {
    const Vector3d p(0.746, y, 0.001);
    EXPECT_LT((2.0 * one.At(p).f_N - two.At(p).f_N).norm(), 1e-12);
    one.MoveTo(p);
    two.MoveTo(p);
  }
}

TEST(SoftCylinder, ThePlantFindsItsEquilibriaInIt) {
  for (const double scale : {0.5, 1.0, 2.0}) {
    SoftCylinder silicone(GelSetup(scale));
    PlantSetup setup;
    setup.instrument = {0.6, kDiameter_m, 0.304, 0.0351};
    setup.p_RP = {0.46, 0.0, 0.0};
    setup.weight_N_m = {0.0, 0.0, -0.344};
    setup.load.other = [&silicone](const Vector3d& p) { return silicone.At(p); };
    Plant plant(setup, {50, 50});
    double worst = 0.0, flexion = 0.0;
    int iterations = 0;
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps; ++i) {  // 40 mm wide circles of the wrist, 7 mm deep, uneven steps
      const double angle = 0.02 * i + 0.01 * std::sin(0.7 * i);
      const double in = std::min(1.0, i / 200.0);
      const Vector3d p_RW(0.135 + 0.012 * in, 0.03 * in * std::sin(angle),
                          0.03 * in * std::cos(1.3 * angle) - 0.03 * in);
      const PlantShape shape = plant.Solve(p_RW);
      ASSERT_TRUE(shape.IsUsable()) << scale << " " << i << ": " << shape.message;
      const Vector3d p_RE = shape.T_RE().p;
      worst = std::max(worst, (shape.f_tip_N - silicone.At(p_RE).f_N).norm());
      flexion = std::max(flexion, shape.f_tip_N.tail<2>().norm());
      iterations += shape.iterations;
      silicone.MoveTo(p_RE);
    }
    EXPECT_LT(worst, 1e-6);
    EXPECT_GT(flexion, 0.05);
    EXPECT_LT(iterations, 12 * kSteps);
  }
}

}  // namespace
}  // namespace flextip::simulation
