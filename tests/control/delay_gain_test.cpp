// The gain under an uncertain delay, against loops that are run: any delay within the deviations,
// any model error within the bound, in all three directions at once.
#include "control/delay_gain.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <deque>
#include <random>

namespace flextip {
namespace {

Eigen::Matrix3d RandomOfSize(double size, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  Eigen::Matrix3d m;
  for (double& v : m.reshaped()) v = normal(rng);
  return size / m.jacobiSvd().singularValues()[0] * m;
}

/// Runs the loop with the tip `delay` cycles late and taken to be `believed` cycles late. Returns
/// the error at the end over that at the start.
double LastOverFirst(double gain, int delay, int believed, const Eigen::Matrix3d& error) {
  const Eigen::Matrix3d J_true = Eigen::Matrix3d::Identity() - error;  // the model's is 1
  const Eigen::Vector3d goal(0.01, -0.004, 0.002);
  std::deque<Eigen::Vector3d> wrist(static_cast<std::size_t>(std::max(delay, believed)) + 1,
                                    Eigen::Vector3d::Zero());  // newest first
  for (int k = 0; k < 6000; ++k) {
    const Eigen::Vector3d seen = J_true * wrist[static_cast<std::size_t>(delay)];
    const Eigen::Vector3d carried =
        seen + (wrist.front() - wrist[static_cast<std::size_t>(believed)]);
    wrist.push_front(wrist.front() + gain * (goal - carried));
    wrist.pop_back();
    if (!(wrist.front().norm() < 1e6)) return 1e6;
  }
  return (goal - J_true * wrist.front()).norm() / goal.norm();
}

TEST(GainUnderDelay, KeepsEveryLoopWithinTheStatedErrorsStable) {
  std::mt19937_64 rng(5);
  std::uniform_int_distribution<int> late(0, 40), off(0, 6);
  std::uniform_real_distribution<double> size(0.0, 0.3);
  for (int i = 0; i < 300; ++i) {
    const int believed = late(rng), cycles = off(rng);
    const int delay = std::max(0, believed + (i % 2 == 0 ? cycles : -cycles));
    DelayUncertainty uncertain{100.0, 0.005 * cycles};  // two deviations are `cycles`
    const double gain = GainUnderDelay(1.0, uncertain);
    const Eigen::Matrix3d error = RandomOfSize(size(rng), rng);
    EXPECT_LT(LastOverFirst(gain, delay, believed, error), 1e-3)
        << "gain " << gain << ", delay " << delay << " believed " << believed;
  }
}

TEST(GainUnderDelay, IsNeeded) {
  EXPECT_GT(LastOverFirst(1.0, 6, 2, 0.3 * Eigen::Matrix3d::Identity()), 1.0);
  EXPECT_LT(GainUnderDelay(1.0, {100.0, 0.02}), 0.5);
}

TEST(GainUnderDelay, AKnownDelayCostsNothing) {
  EXPECT_EQ(GainUnderDelay(0.8, {120.0, 0.0}), 0.8);
  EXPECT_EQ(GainUnderDelay(1.0, {}), 1.0);
  EXPECT_LT(LastOverFirst(1.0, 30, 30, 0.3 * Eigen::Matrix3d::Identity()), 1e-9);
}

TEST(GainUnderDelay, FallsWithTheDoubt) {
  double last = 1.0;
  for (const double sd_s : {0.001, 0.002, 0.004, 0.008, 0.016, 0.032}) {
    const double gain = GainUnderDelay(1.0, {120.0, sd_s});
    EXPECT_LT(gain, last);
    EXPECT_GT(gain, 0.0);
    last = gain;
  }
}

}  // namespace
}  // namespace flextip
