// The limit of jerk behind that of acceleration, on random wishes.
#include "control/supervision/jerk_filter.h"

#include <gtest/gtest.h>

#include <random>

#include "control/supervision/rate_limits.h"

namespace flextip {
namespace {

const Eigen::Vector3d kZero = Eigen::Vector3d::Zero();

TEST(JerkFilter, KeepsTheJerkAndReachesThePlaceWithoutOvershoot) {
  std::mt19937_64 rng(7);
  std::normal_distribution<double> normal(0.0, 0.01);
  constexpr double kAcceleration = 1.0, kJerk = 40.0;
  for (const double rate_hz : {30.0, 120.0, 1000.0}) {
    const double dt_s = 1.0 / rate_hz;
    for (int trial = 0; trial < 20; ++trial) {
      JerkFilter filter({.max_acceleration_m_s2 = kAcceleration, .max_jerk_m_s3 = kJerk}, rate_hz);
      filter.Reset(kZero);
      Eigen::Vector3d goal;
      for (double& x : goal) x = normal(rng);
      Eigen::Vector3d p = kZero, v = kZero, sent = kZero, v_sent = kZero, a_sent = kZero;
      double farthest = 0.0;
      for (int i = 0; i < 3.0 * rate_hz; ++i) {
        const Eigen::Vector3d next = LimitAcceleration(p, v, goal, dt_s, kAcceleration).p;
        v = (next - p) / dt_s;
        p = next;
        const Eigen::Vector3d sent_next = filter.Next(p), v_next = (sent_next - sent) / dt_s;
        const Eigen::Vector3d a_next = (v_next - v_sent) / dt_s;
        EXPECT_LE((a_next - a_sent).norm() / dt_s, kJerk * (1.0 + 1e-6));
        sent = sent_next;
        v_sent = v_next;
        a_sent = a_next;
        farthest = std::max(farthest, sent.dot(goal.normalized()));
      }
      EXPECT_LT((sent - goal).norm(), 1e-9);
      EXPECT_LT(farthest, goal.norm() + 1e-9);
    }
  }
}

TEST(JerkFilter, WithoutALimitCommandsGoThrough) {
  JerkFilter filter({.max_acceleration_m_s2 = 1.0}, 120.0);
  EXPECT_FALSE(filter.Limits());
  EXPECT_EQ(filter.Next({1.0, 2.0, 3.0}), Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_DOUBLE_EQ(JerkFilter::LeastJerk(1.0, 128.0), 4.0);
}

}  // namespace
}  // namespace flextip
