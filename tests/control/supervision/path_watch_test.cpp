// The tip beside its way, on motions counted by hand.
#include "control/supervision/path_watch.h"

#include <gtest/gtest.h>

namespace flextip {
namespace {

const Eigen::Matrix3d kCovariance_m2 = 1e-10 * Eigen::Matrix3d::Identity();  // 0.01 mm
constexpr TimeNs kCycle_ns = 33'000'000;

/// A wish that goes along x at 15 mm/s, and a tip beside it.
struct Walk {
  PathWatch watch{0.0018, 0.0};
  TimeNs t_ns = 1'000'000'000;
  double x_m = 0.0;
  Eigen::Vector3d p_last = Eigen::Vector3d::Zero();

  bool Next(double beside_m, double behind_m = 0.0, bool goes = true) {
    t_ns += kCycle_ns;
    if (goes) x_m += 0.015 * 0.033;
    const Eigen::Vector3d p(x_m - behind_m, beside_m, 0.0), way = p - p_last;
    p_last = p;
    return watch.IsAstray(t_ns, {p, kCovariance_m2}, way, {x_m, 0.0, 0.0});
  }
};

TEST(PathWatch, ATipThatLeavesItsWayIsFoundAtTheLimit) {
  Walk walk;
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(walk.Next(0.0002));
  for (int i = 0; i < 40; ++i) {
    const double beside_m = 0.0002 + 0.0001 * i;
    // Within the filter's two deviations of the limit either is right.
    if (std::abs(beside_m - 0.0018) < 0.0002) continue;
    EXPECT_EQ(walk.Next(beside_m), beside_m > 0.0018) << i;
  }
}

TEST(PathWatch, ATipThatMayBeBeyondTheLimitIsInDoubt) {
  PathWatch watch(0.0018, 0.0003);  // certain from 2.7 mm on
  for (int i = 0; i < 40; ++i) {
    const TimeNs t_ns = 1'000'000'000 + i * kCycle_ns;
    const double beside_m = 0.0001 * i;
    const Eigen::Vector3d p(0.0, beside_m, 0.0), way(0.0, 0.0001, 0.0);
    const bool astray = watch.IsAstray(t_ns, {p, kCovariance_m2}, way, {0.0, 0.0, 0.0});
    if (std::abs(beside_m - 0.0018) < 0.00005 || std::abs(beside_m - 0.0027) < 0.0001) continue;
    EXPECT_EQ(watch.MayBeAstray(), beside_m > 0.0018) << i;
    EXPECT_EQ(astray, beside_m > 0.0027) << i;
  }
}

// May be 1.8 mm beside its way: a step leads it to 1.44 mm at most.
TEST(PathWatch, AStepKeepsTheTipToItsWay) {
  using Eigen::Vector3d;
  const auto beside = [](double beside_m) {
    Walk walk;
    for (int i = 0; i < 20; ++i) walk.Next(beside_m, 0.002);
    return walk.watch;
  };
  const auto near = [](const Vector3d& kept, const Vector3d& expected) {
    EXPECT_LT((kept - expected).norm(), 2e-5) << kept.transpose();  // the filter's noise
  };
  const Vector3d none = Vector3d::Zero();
  const PathWatch inside = beside(0.001), edge = beside(0.0014), outside = beside(0.0022);
  near(inside.Kept(none, {0.001, 0.0004, 0}), {0.001, 0.0004, 0});
  near(inside.Kept(none, {0.0016, 0.0016, 0}), {0.0004, 0.0004, 0});            // to 1.4, not 1.8
  near(inside.Kept({0, 0.0003, 0}, {0.001, 0.0004, 0}), {0.00025, 0.0001, 0});  // from 1.3 on
  near(edge.Kept(none, {0.001, 0.002, 0}), {0.001, 0.00004, 0});  // along it all, across to 1.44
  near(edge.Kept(none, {0.001, -0.002, 0}), {0.001, -0.002, 0});
  near(outside.Kept(none, {0.001, 0.001, 0}), {0.001, 0.0, 0});  // not farther than it is
  near(outside.Kept(none, {0.001, -0.001, 0}), {0.001, -0.001, 0});
}

TEST(PathWatch, LaggingBehindIsNotLeaving) {
  Walk walk;
  for (int i = 0; i < 60; ++i) EXPECT_FALSE(walk.Next(0.0, std::min(walk.x_m, 0.006)));
}

TEST(PathWatch, BehindAGoalThatWaitsIsNotLeaving) {
  Walk walk;
  for (int i = 0; i < 30; ++i) EXPECT_FALSE(walk.Next(0.0));
  for (int i = 0; i < 90; ++i) EXPECT_FALSE(walk.Next(0.0, 0.003, false)) << i;
  bool found = false;
  for (int i = 0; i < 10; ++i) found |= walk.Next(0.004, 0.003, false);
  EXPECT_TRUE(found);
}

TEST(PathWatch, ATipThatComesNearerMayGoOn) {
  Walk walk;
  EXPECT_TRUE(walk.Next(0.01, 0.0, false));
  int found = 0;
  for (int i = 0; i < 40; ++i) found += walk.Next(0.01 - 0.0002 * i, 0.0, false);
  EXPECT_LE(found, 8);  // until a quarter of a second is known
  EXPECT_TRUE(walk.Next(0.0065, 0.0, false));
}

TEST(PathWatch, AWishThatJumpsIsAWayToGo) {
  Walk walk;
  for (int i = 0; i < 10; ++i) walk.Next(0.0);
  // The tip is still at the old wish, which is a part of the way.
  walk.t_ns += kCycle_ns;
  EXPECT_FALSE(walk.watch.IsAstray(walk.t_ns, {{walk.x_m, 0, 0}, kCovariance_m2}, {0, 0, 0},
                                   {walk.x_m, 0.01, 0}));
}

TEST(PathWatch, AfterAHoldTheTipComesBackFromWhereItIs) {
  Walk walk;
  EXPECT_TRUE(walk.Next(0.005, 0.0, false));
  walk.watch.ComeBack(walk.t_ns);
  EXPECT_FALSE(walk.Next(0.005, 0.0, false));
  EXPECT_FALSE(walk.Next(0.0048, 0.0, false));
  EXPECT_TRUE(walk.Next(0.0053, 0.0, false));
}

TEST(PathWatch, ATipThatDoesNotFollowTheWristIsFound) {
  for (const double part : {1.0, 0.5, 0.1}) {
    PathWatch watch(0.0018, 0.0);
    bool found = false;
    for (int i = 0; i < 20; ++i) {
      const TimeNs t_ns = 1'000'000'000 + i * kCycle_ns;
      const Eigen::Vector3d led(0.001, 0.0, 0.0), p = part * i * led;
      watch.IsAstray(t_ns, {p, kCovariance_m2}, led, p);
      found |= watch.MovesOtherwise(t_ns);
    }
    EXPECT_EQ(found, part < 0.4) << part;
  }
}

// Tissue of 60 N/m before a shaft of 20 N/m at its tip leaves a quarter of the way.
TEST(PathWatch, ATipInTissueThatIsJustTouchedFollowsTheWrist) {
  for (const bool caught : {false, true}) {
    PathWatch watch(0.002, 0.0);
    bool found = false;
    const Eigen::Vector3d way(0.001, 0.0, 0.0);
    Eigen::Vector3d p(0.0, 0.0, 0.0);
    for (int i = 0; i < 30; ++i) {
      p += (caught ? 0.05 : 0.25) * way;
      const TimeNs t_ns = 1'000'000'000 + i * kCycle_ns;
      watch.IsAstray(t_ns, {p, kCovariance_m2}, way, p);
      found |= watch.MovesOtherwise(t_ns);
    }
    EXPECT_EQ(found, caught);
  }
}

// A press that the tip's noise makes look like a catch for a third of a second: 5.3 mm that the
// wrist leads, of which the tip is seen to go a tenth.
TEST(PathWatch, AMomentOfTissueIsNoCatch) {
  PathWatch watch(0.002, 0.0);
  const Eigen::Matrix3d covariance_m2 = 2e-8 * Eigen::Matrix3d::Identity();  // 0.2 mm of a motion
  const Eigen::Vector3d way(0.00066, 0.0, 0.0);
  Eigen::Vector3d p(0.0, 0.0, 0.0);
  for (int i = 0; i < 30; ++i) {
    p += (i > 10 && i <= 18 ? 0.11 : 0.6) * way;
    const TimeNs t_ns = 1'000'000'000 + i * kCycle_ns;
    watch.IsAstray(t_ns, {p, covariance_m2}, way, p);
    EXPECT_FALSE(watch.MovesOtherwise(t_ns)) << i;
  }
}

TEST(PathWatch, ATipThatIsThrownMovesOtherwise) {
  PathWatch watch(0.0018, 0.0);
  for (int i = 0; i < 20; ++i) {
    const TimeNs t_ns = 1'000'000'000 + i * kCycle_ns;
    const Eigen::Vector3d p(0.0, i < 10 ? 0.0 : 0.004, 0.0);
    watch.IsAstray(t_ns, {p, kCovariance_m2}, {0.0, 0.0, 0.0}, p);
    EXPECT_EQ(watch.MovesOtherwise(t_ns), i >= 10) << i;  // for 0.4 s
  }
}

TEST(PathWatch, WithoutALimitNothingIsFound) {
  PathWatch watch(0.0, 0.0);
  EXPECT_FALSE(watch.IsAstray(1, {{1, 0, 0}, kCovariance_m2}, {0, 0, 0}, {0, 0, 0}));
}

}  // namespace
}  // namespace flextip
