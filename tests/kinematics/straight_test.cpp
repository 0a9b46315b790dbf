#include "kinematics/straight.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "core/derivative_check.h"
#include "core/draw_vector.h"

namespace flextip {
namespace {

TEST(Straight, TipLiesBehindThePortOnTheLineFromTheWrist) {
  const StraightShaft shaft = SolveStraight({1, 2, 3}, {1, 2.1, 3}, 0.4);
  ASSERT_TRUE(shaft.IsUsable());
  EXPECT_LT((shaft.p_tip - Eigen::Vector3d(1, 2.4, 3)).norm(), 1e-15);
  EXPECT_LT((shaft.t - Eigen::Vector3d::UnitY()).norm(), 1e-15);
}

TEST(Straight, JacobiansMatchCentralDifferences) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const auto random = [&] { return DrawVector<3>(uniform, rng); };
  const double L = 0.4;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d wrist = random();
    // Left out: a wrist closer than 0.1 L to the port, where the Jacobian itself goes to infinity.
    const double distance = L * (0.55 + 0.44 * uniform(rng));
    const Eigen::Vector3d port = wrist + distance * random().normalized();
    const StraightShaft shaft = SolveStraight(wrist, port, L);
    ASSERT_TRUE(shaft.IsUsable());
    const double step = 1e-3 * distance;
    const Eigen::MatrixXd by_wrist = NumericJacobian(
        [&](const Eigen::VectorXd& p) { return SolveStraight(p, port, L).p_tip; }, wrist, step);
    const Eigen::MatrixXd by_port = NumericJacobian(
        [&](const Eigen::VectorXd& p) { return SolveStraight(wrist, p, 1.0001 * L).p_tip; }, port,
        step);
    EXPECT_LT((by_wrist - shaft.J_tip_wrist).norm(), 1e-8 * by_wrist.norm());
    EXPECT_LT((by_port - SolveStraight(wrist, port, 1.0001 * L).J_tip_port).norm(),
              1e-8 * by_port.norm());
  }
}

TEST(Straight, StatusSaysWhyThereIsNoShaft) {
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero(), port(0.1, 0, 0);
  EXPECT_EQ(SolveStraight(origin, origin, 0.3).status, StraightStatus::kOnPort);
  EXPECT_EQ(SolveStraight(origin, port, 0.1).status, StraightStatus::kUnreachable);
  EXPECT_EQ(SolveStraight(origin, port, 0.05).status, StraightStatus::kUnreachable);
  EXPECT_EQ(SolveStraight(origin, port, -1).status, StraightStatus::kBadInput);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(SolveStraight({nan, 0, 0}, port, 0.3).status, StraightStatus::kBadInput);
  EXPECT_TRUE(SolveStraight(origin, origin, 0.3).J_tip_wrist.isZero());
}

}  // namespace
}  // namespace flextip
