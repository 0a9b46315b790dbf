// Wrist motions: within reach and speed, smooth, families apart.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "testdata/hidden/motion.h"

namespace flextip::hidden {
namespace {

class MotionTest : public testing::TestWithParam<int> {
 protected:
  MotionSetup SetupOf(int seed) const {
    MotionSetup setup;
    setup.kind = static_cast<MotionKind>(GetParam());
    setup.length_m = 0.35 + 0.025 * (seed % 11);
    setup.p_RP = {0.01, -0.02, 0.005};
    setup.axis = Eigen::Vector3d(1.0, 0.3, -0.2).normalized();
    setup.peak_speed_m_s = 0.06 + 0.014 * (seed % 10);
    return setup;
  }
};

TEST_P(MotionTest, StaysWithinDepthAngleAndSpeed) {
  for (int seed = 0; seed < 30; ++seed) {
    const MotionSetup setup = SetupOf(seed);
    const WristCourse motion(setup, seed, 20.0);
    double peak = 0.0, way = 0.0;
    for (int i = -50; i < 1000; ++i) {
      const double t = 0.02 * i;
      const Eigen::Vector3d to_port = setup.p_RP - motion.At(t);
      const double depth = 1.0 - to_port.norm() / setup.length_m;
      ASSERT_GE(depth, 0.4 - 1e-9) << Name(setup.kind) << " seed " << seed << " at " << t;
      ASSERT_LE(depth, 0.7 + 1e-9) << Name(setup.kind) << " seed " << seed << " at " << t;
      // +-20 degrees both ways: in the corner their tangents add up.
      const double tangent = std::sqrt(2.0) * std::tan(setup.angle_rad);
      ASSERT_LE(std::acos(std::min(1.0, to_port.normalized().dot(setup.axis))),
                std::atan(tangent) + 1e-9);
      if (i < 0) continue;
      const double step = (motion.At(t + 0.02) - motion.At(t)).norm();
      peak = std::max(peak, step / 0.02);
      way += step;
    }
    EXPECT_LE(peak, setup.peak_speed_m_s * 1.001) << Name(setup.kind) << " seed " << seed;
    EXPECT_GE(peak, 0.03) << Name(setup.kind) << " seed " << seed;
    EXPECT_GE(way / 20.0, 0.01) << Name(setup.kind) << " seed " << seed;
  }
}

TEST_P(MotionTest, IsSmooth) {
  for (int seed = 0; seed < 10; ++seed) {
    const WristCourse motion(SetupOf(seed), seed, 20.0);
    // A jump of the velocity would show as one that does not shrink with the step.
    const auto worst = [&](double h) {
      double jump = 0.0;
      for (double t = 0.0; t < 20.0; t += 0.01) {
        const Eigen::Vector3d change = motion.At(t + h) - 2.0 * motion.At(t) + motion.At(t - h);
        jump = std::max(jump, change.norm() / h);
      }
      return jump;
    };
    EXPECT_LT(worst(0.001), 0.004) << seed;  // accelerations below 4 m/s^2
  }
}

TEST_P(MotionTest, SameSeedSameMotion) {
  const WristCourse a(SetupOf(1), 7, 20.0), b(SetupOf(1), 7, 20.0), other(SetupOf(1), 8, 20.0);
  EXPECT_EQ(a.At(3.3), b.At(3.3));
  EXPECT_NE(a.At(3.3), other.At(3.3));
}

INSTANTIATE_TEST_SUITE_P(Kinds, MotionTest, testing::Range(0, kMotionKinds), [](const auto& kind) {
  return std::string(Name(static_cast<MotionKind>(kind.param)));
});

TEST(MotionFamilies, ShareNothing) {
  for (const MotionKind kind : Kinds(MotionFamily::kTuning)) {
    EXPECT_THAT(Kinds(MotionFamily::kHeldOut), testing::Not(testing::Contains(kind)));
  }
  EXPECT_EQ(Kinds(MotionFamily::kTuning).size() + Kinds(MotionFamily::kHeldOut).size(),
            Kinds(MotionFamily::kAny).size());
}

}  // namespace
}  // namespace flextip::hidden
