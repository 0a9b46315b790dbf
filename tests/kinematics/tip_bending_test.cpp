// The free end beyond a collar against the elastica, and against integration of the weight.
#include "kinematics/tip_bending.h"

#include <gtest/gtest.h>

#include "core/rotation.h"
#include "kinematics/large_deflection.h"

namespace flextip {
namespace {

const Pose kTip{ExpRotation({0.4, -1.1, 0.3}), {0.1, 0.02, -0.05}};

TEST(TipBending, IsTheElasticaWhereItBendsLittle) {
  for (const double slope : {0.003, 0.02, 0.1}) {
    const FreeEnd end{0.03, 0.05, Eigen::Vector3d::Zero()};
    const double force_N = 2 * slope * end.bending_stiffness_Nm2 / (end.length_m * end.length_m);
    const Eigen::Vector3d side = kTip.R.col(1);
    const Pose bent = BendFreeEnd(end, force_N * side + 3.0 * kTip.R.col(0), kTip);
    const Cantilever exact = BendCantilever(slope);
    const Eigen::Vector3d moved = bent.p - kTip.p;
    const double deflection_m = end.length_m * exact.deflection;
    EXPECT_NEAR(moved.dot(side), deflection_m, 0.5 * slope * slope * deflection_m);
    EXPECT_NEAR(moved.dot(kTip.R.col(2)), 0, 1e-15);
    // What is left out is the shortening, of second order.
    EXPECT_NEAR(moved.dot(kTip.R.col(0)), end.length_m * (exact.reach - 1),
                slope * slope * end.length_m);
    const double turned = std::asin(bent.R.col(0).dot(side));
    EXPECT_NEAR(turned, exact.phi_end_rad, slope * slope * slope);
  }
}

// The weight as many small forces, each bending what lies before it.
TEST(TipBending, CarriesItsWeight) {
  FreeEnd end{0.04, 0.02, {1.0, -2.0, 0.5}};
  constexpr int kParts = 2000;
  Eigen::Vector3d moved = Eigen::Vector3d::Zero(), slope = moved;
  const Eigen::Vector3d d = kTip.R.col(0);
  const Eigen::Vector3d q = end.weight_N_m - end.weight_N_m.dot(d) * d;
  for (int i = 0; i < kParts; ++i) {
    const double s = (i + 0.5) * end.length_m / kParts, rest = end.length_m - s;
    const Eigen::Vector3d f = q * end.length_m / kParts;
    const Eigen::Vector3d turn = f * s * s / (2 * end.bending_stiffness_Nm2);
    slope += turn;
    moved += f * s * s * s / (3 * end.bending_stiffness_Nm2) + rest * turn;
  }
  const Pose bent = BendFreeEnd(end, Eigen::Vector3d::Zero(), kTip);
  EXPECT_LT((bent.p - kTip.p - moved).norm(), 1e-5 * moved.norm());
  EXPECT_LT((LogRotation(bent.R * kTip.R.transpose()) - d.cross(slope)).norm(),
            1e-5 * slope.norm());
}

TEST(TipBending, MovesByItsCompliance) {
  const FreeEnd end{0.02, 0.3, Eigen::Vector3d::Zero()};
  const Pose bent = BendFreeEnd(end, kTip.R.col(2), kTip);
  EXPECT_NEAR((bent.p - kTip.p).norm(), FreeEndCompliance(end), 1e-15);
  EXPECT_EQ(BendFreeEnd({0, 0.3, {9, 9, 9}}, kTip.R.col(2), kTip).p, kTip.p);
}

// The compliance to a load on the tip is the integral of x^2 / E I(x), x from the tip.
TEST(TipBending, ATaperedEndGivesAsItsIntegral) {
  const Instrument shaft{.length_m = 0.5, .bending_stiffness_Nm2 = 0.1, .stiffness_taper = -0.8};
  TagCollar collar;
  CollarTag tag;
  tag.size_m = 0.004;
  tag.T_EG.p.x() = -0.062;
  collar.tags = {tag};
  const FreeEnd end = FreeEndOf(shaft, collar, Eigen::Vector3d::Zero());
  ASSERT_NEAR(end.length_m, 0.06, 1e-12);
  constexpr int kParts = 2000;
  double compliance = 0;
  for (int i = 0; i < kParts; ++i) {
    const double x = (i + 0.5) * end.length_m / kParts, s = shaft.length_m - x;
    const double EI = 0.1 * (1 - 0.8 * (s / 0.5 - 0.5));
    compliance += x * x / EI * end.length_m / kParts;
  }
  EXPECT_NEAR(FreeEndCompliance(end), compliance, 1e-3 * compliance);
  const FreeEnd middle{end.length_m, shaft.bending_stiffness_Nm2};
  EXPECT_GT(compliance, 1.3 * FreeEndCompliance(middle));  // what the taper is worth there
}

}  // namespace
}  // namespace flextip
