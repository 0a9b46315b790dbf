// The Jacobians against differences of positions worked out without the library's kinematics.
#include <gtest/gtest.h>

#include <cmath>

#include "draw.h"

namespace flextip {
namespace {

/// The tip of a robot whose base, at the true arm's place, and port are given in A: trigonometry
/// from the shoulder outward.
Eigen::Vector2d TipOf(const Eigen::Vector2d& shoulder, double link1, double link2, double shaft,
                      const Eigen::Vector2d& port, const Eigen::Vector2d& theta) {
  const Eigen::Vector2d elbow =
      shoulder + link1 * Eigen::Vector2d(std::cos(theta[0]), std::sin(theta[0]));
  const double angle = theta[0] + theta[1] - 0.5 * M_PI;  // of the second link above z
  const Eigen::Vector2d wrist = elbow + link2 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  return wrist + shaft * (port - wrist).normalized();
}

TEST(Believe, IsTheDerivativeOfTheBelievedTipInThePlane) {
  std::mt19937_64 rng(1);
  const PortInstrument<2> truth;
  for (int i = 0; i < 200; ++i) {
    const auto state = DrawState(truth, rng);
    const auto error = i == 0 ? BeliefError<2>{} : DrawError<2>(rng);
    const auto belief = Believe(truth, error, state.theta);
    ASSERT_TRUE(belief);
    const auto tip = [&](const Eigen::Vector2d& theta) {
      return TipOf({-0.21, 0.21}, 0.21 + error.links_m[0], 0.21 + error.links_m[1],
                   0.32 + error.shaft_m, truth.p_port + error.port_m, theta + error.joints_rad);
    };
    constexpr double kStep = 1e-5;
    for (int j = 0; j < 2; ++j) {
      const Eigen::Vector2d h = kStep * Eigen::Vector2d::Unit(j);
      const Eigen::Vector2d slope = (tip(state.theta + h) - tip(state.theta - h)) / (2.0 * kStep);
      EXPECT_LT((belief->J_hat.col(j) - slope).norm(), 1e-6 * (1.0 + slope.norm())) << i;
    }
    if (i == 0) {
      EXPECT_LT((belief->J_hat - state.J).norm(), 1e-13);
    }
  }
}

TEST(Believe, IsTheDerivativeOfTheBelievedTipInSpace) {
  std::mt19937_64 rng(2);
  const PortInstrument<3> truth;
  for (int i = 0; i < 200; ++i) {
    const auto state = DrawState(truth, rng);
    const auto error = DrawError<3>(rng);
    const auto belief = Believe(truth, error, state.theta);
    ASSERT_TRUE(belief);
    // In the arm's own plane, turned about the vertical through the shoulder.
    const auto tip = [&](const Eigen::Vector3d& theta) {
      const Eigen::Vector3d t = theta + error.joints_rad;
      const double l1 = 0.21 + error.links_m[0], l2 = 0.21 + error.links_m[1];
      const double reach = l1 * std::cos(t[1]) + l2 * std::sin(t[1] + t[2]);
      const double height = 0.21 + l1 * std::sin(t[1]) - l2 * std::cos(t[1] + t[2]);
      const Eigen::Vector3d wrist(-reach * std::sin(t[0]), height, -0.21 + reach * std::cos(t[0]));
      const Eigen::Vector3d port = truth.p_port + error.port_m;
      return Eigen::Vector3d(wrist + (0.32 + error.shaft_m) * (port - wrist).normalized());
    };
    constexpr double kStep = 1e-5;
    for (int j = 0; j < 3; ++j) {
      const Eigen::Vector3d h = kStep * Eigen::Vector3d::Unit(j);
      const Eigen::Vector3d slope = (tip(state.theta + h) - tip(state.theta - h)) / (2.0 * kStep);
      EXPECT_LT((belief->J_hat.col(j) - slope).norm(), 1e-6 * (1.0 + slope.norm())) << i;
    }
  }
}

TEST(Believe, HasNoJacobianWithTheWristOnThePort) {
  const PortInstrument<2> truth;
  const Eigen::Vector2d theta(0.1, 0.2);
  const BeliefError<2> error{.port_m = truth.arm.Wrist(theta) - truth.p_port};
  EXPECT_FALSE(Believe(truth, error, theta));
}

TEST(BeliefError, GoesToAVectorAndBack) {
  std::mt19937_64 rng(3);
  const auto error = DrawError<3>(rng);
  const auto v = error.AsVector();
  EXPECT_EQ(BeliefError<3>::FromVector(v).AsVector(), v);
  EXPECT_EQ(v[4], error.links_m[1]);
  EXPECT_STREQ(ErrorName<3>(4), "link 2");
  EXPECT_STREQ(ErrorName<2>(0), "port z");
}

}  // namespace
}  // namespace flextip
