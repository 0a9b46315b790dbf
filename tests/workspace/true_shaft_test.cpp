// Tips and wrists of straight and bent shafts.
#include "workspace/true_shaft.h"

#include <gtest/gtest.h>

#include "draw.h"

namespace flextip {
namespace {

template <int N>
void CheckThereAndBack(const std::optional<TipForce<N>>& force, unsigned seed) {
  std::mt19937_64 rng(seed);
  const PortInstrument<N> instrument;
  for (int i = 0; i < 60; ++i) {
    TrueShaft<N> shaft(instrument, force);
    const auto there = shaft.AtJoints(DrawState(instrument, rng).theta);
    ASSERT_TRUE(there);
    const auto back = shaft.AtTip(there->p_tip);
    ASSERT_TRUE(back) << i;
    EXPECT_LT((back->p_wrist - there->p_wrist).norm(), 1e-7) << i;
    EXPECT_LT((back->theta - there->theta).norm(), 1e-6) << i;
    constexpr double kStep = 1e-5;
    for (int j = 0; j < N; ++j) {
      const VectorN<N> h = kStep * VectorN<N>::Unit(j);
      const VectorN<N> slope =
          (shaft.AtJoints(there->theta + h)->p_tip - shaft.AtJoints(there->theta - h)->p_tip) /
          (2.0 * kStep);
      EXPECT_LT((there->J.col(j) - slope).norm(), 1e-6 * (1.0 + slope.norm())) << i;
    }
  }
}

TEST(TrueShaft, StraightInThePlane) { CheckThereAndBack<2>(std::nullopt, 1); }
TEST(TrueShaft, StraightInSpace) { CheckThereAndBack<3>(std::nullopt, 2); }
TEST(TrueShaft, BentInThePlane) {
  CheckThereAndBack<2>(TipForce<2>{.bending_stiffness_Nm2 = 0.304, .force_N = {0.5, -2.0}}, 3);
}
TEST(TrueShaft, BentInSpace) {
  CheckThereAndBack<3>(TipForce<3>{.bending_stiffness_Nm2 = 0.304, .force_N = {1.0, -2.0, 0.5}}, 4);
}

TEST(TrueShaft, TheTipLiesBeyondThePortOnTheLineFromTheWrist) {
  std::mt19937_64 rng(5);
  const PortInstrument<3> instrument;
  for (int i = 0; i < 100; ++i) {
    const auto state = DrawState(instrument, rng);
    const Eigen::Vector3d outer = instrument.p_port - state.p_wrist,
                          inner = state.p_tip - instrument.p_port;
    EXPECT_NEAR(outer.norm() + inner.norm(), instrument.shaft_m, 1e-14);
    EXPECT_LT(outer.cross(inner).norm(), 1e-14);
    EXPECT_GT(outer.dot(inner), 0.0);
  }
}

TEST(TrueShaft, IsNowhereOutsideItsReachAndTheArmsLimits) {
  const PortInstrument<2> instrument;
  TrueShaft<2> shaft(instrument, std::nullopt);
  EXPECT_TRUE(shaft.AtTip({0.32, 0.0}));
  EXPECT_FALSE(shaft.AtTip(instrument.p_port));
  EXPECT_FALSE(shaft.AtTip({0.49, 0.0}));    // further from the port than the shaft is long
  EXPECT_FALSE(shaft.AtTip({0.16, 0.05}));   // the wrist would be below, past a joint's limit
  EXPECT_FALSE(shaft.AtJoints({1.2, 1.0}));  // the wrist is high up, too far from the port
}

}  // namespace
}  // namespace flextip
