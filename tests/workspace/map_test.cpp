// Maps of the measures.
#include "workspace/map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "draw.h"

namespace flextip {
namespace {

MapSetup<2> Chapter2() { return {.truth = {}, .error = {.port_m = {0.01, 0.02}}}; }

TEST(Map, HoldsEveryPointOfItsGridThatTheTipCanReach) {
  const MapSetup<2> setup = Chapter2();
  const auto map = ComputeMap(setup, Slice<2>{}, 0.01);
  ASSERT_EQ(map.points.size(), map.right_m.size() * map.up_m.size());
  std::size_t reached = 0;
  TrueShaft<2> shaft(setup.truth, std::nullopt);
  for (int r = -40; r <= 40; ++r) {
    for (int c = -40; c <= 60; ++c) {
      const auto state = shaft.AtTip({0.01 * c, 0.01 * r});
      reached += state ? 1 : 0;
    }
  }
  EXPECT_EQ(map.Reached(), reached);
  EXPECT_GT(reached, 300U);
}

/// What a controller does with one short step, against what the map says of it.
template <int N>
void CheckSteps(const MapSetup<N>& setup, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::normal_distribution<double> normal;
  TrueShaft<N> shaft(setup.truth, setup.force);
  int checked = 0;
  for (int i = 0; i < 100; ++i) {
    const auto at = MeasureAt(setup, shaft, DrawState(setup.truth, rng).p_tip);
    if (!at.state || !at.A) continue;
    ++checked;
    double largest = 0.0, largest_angle = 0.0;
    for (int k = 0; k < 200; ++k) {
      VectorN<N> v;
      for (double& x : v) x = normal(rng);
      v.normalize();
      if (k == 0) v = at.step.v_sigma;
      if (k == 1) v = at.angle.p_phi;
      constexpr double kShort = 1e-6;
      const auto belief = Believe(setup.truth, setup.error, at.state->theta);
      const VectorN<N> theta =
          at.state->theta + setup.gain * belief->J_hat.inverse() * (kShort * v);
      const VectorN<N> moved = (shaft.AtJoints(theta)->p_tip - at.state->p_tip) / kShort;
      EXPECT_NEAR((v - moved).norm(), DirectionError<N>(*at.A, v, MotionFault::kNorm),
                  1e-3 * (1.0 + at.step.norm) * (1.0 + moved.norm()));
      largest = std::max(largest, DirectionError<N>(*at.A, v, MotionFault::kNorm));
      largest_angle = std::max(largest_angle, DirectionError<N>(*at.A, v, MotionFault::kAngle));
    }
    EXPECT_NEAR(largest, at.step.norm, 1e-9 * (1.0 + at.step.norm));
    EXPECT_NEAR(largest_angle, at.angle.phi_max_rad, 1e-6);
  }
  EXPECT_GT(checked, 50);
}

TEST(Map, SaysWhatAShortStepDoesInThePlane) { CheckSteps(Chapter2(), 1); }
TEST(Map, SaysWhatAShortStepDoesInSpace) {
  std::mt19937_64 rng(2);
  CheckSteps<3>({.truth = {}, .error = DrawError<3>(rng), .gain = 0.7}, 3);
}
TEST(Map, SaysWhatAShortStepDoesToABentShaft) {
  const TipForce<2> force{.bending_stiffness_Nm2 = 0.304, .force_N = {0.0, -3.0}};
  CheckSteps<2>({.truth = {}, .force = force}, 4);
}

TEST(Map, HasNoErrorsWithoutAny) {
  const auto map = ComputeMap<2>({.truth = {}}, {}, 0.01);
  for (const auto& at : map.points) {
    if (!at.state) continue;
    EXPECT_LT(at.step.norm, 1e-10);
    EXPECT_LT(at.angle.phi_max_rad, 1e-10);
  }
}

TEST(Map, OfThreeJointsInTheirPlaneHasThePlanarArmsInPlaneErrorsAtLeast) {
  const MapSetup<3> space{.truth = {}, .error = {.port_m = {0.0, 0.02, 0.01}}};
  const auto plane = ComputeMap(Chapter2(), {}, 0.02);
  const auto slice = ComputeMap(space, Slice<3>{}, 0.02);
  ASSERT_EQ(slice.right_m, plane.right_m);
  ASSERT_EQ(slice.up_m, plane.up_m);
  for (std::size_t i = 0; i < plane.points.size(); ++i) {
    ASSERT_EQ(plane.points[i].state.has_value(), slice.points[i].state.has_value());
    if (!plane.points[i].A) continue;
    EXPECT_GE(slice.points[i].step.norm, plane.points[i].step.norm * (1.0 - 1e-9));
    EXPECT_GE(slice.points[i].angle.phi_max_rad, plane.points[i].angle.phi_max_rad - 1e-6);
    // In the plane nothing couples to x, by symmetry.
    const Eigen::Matrix3d& A = *slice.points[i].A;
    EXPECT_NEAR(A(2, 2), (*plane.points[i].A)(0, 0), 1e-9 * (1.0 + A.norm()));
    EXPECT_NEAR(A(2, 1), (*plane.points[i].A)(0, 1), 1e-9 * (1.0 + A.norm()));
    EXPECT_NEAR(A(0, 1), 0.0, 1e-9 * (1.0 + A.norm()));
  }
}

TEST(Slice, LiesAcrossItsAxis) {
  const Slice<3> slice{.right = 0, .up = 1, .offset_m = 0.3};
  const auto map = ComputeMap<3>({.truth = {}}, slice, 0.02);
  EXPECT_GT(map.Reached(), 50U);
  for (const auto& at : map.points) EXPECT_EQ(at.p_tip.z(), 0.3);
  EXPECT_EQ(slice.InPlane({0.1, 0.2, 0.3}), Eigen::Vector2d(0.1, 0.2));
}

TEST(Map, PartAroundPlacesIsTheSameMap) {
  const auto map = ComputeMap(Chapter2(), {}, 0.01);
  const auto part = PartAround(map, {{0.3, 0.0}, {0.34, -0.1}}, 0.02);
  ASSERT_EQ(part.right_m.size(), 9U);  // 280 to 360 mm
  ASSERT_EQ(part.up_m.size(), 15U);    // -120 to 20 mm
  for (std::size_t r = 0; r < part.up_m.size(); ++r) {
    for (std::size_t c = 0; c < part.right_m.size(); ++c) {
      const Eigen::Vector2d p(part.right_m[c], part.up_m[r]);
      EXPECT_EQ(part.At(r, c).p_tip, p);
    }
  }
}

}  // namespace
}  // namespace flextip
