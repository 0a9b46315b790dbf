// The descent against problems whose minimum is known (More, Garbow and Hillstrom, TOMS 1981).
#include "core/levenberg_marquardt.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace flextip {
namespace {

/// Residuals with their derivatives at one place.
struct Residuals {
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
};

/// Minimises |r(x)|^2 from `x`, which it moves; `evaluate` returns false where there are none.
DescentResult MinimiseSquares(
    const std::function<bool(const Eigen::VectorXd& x, Residuals& at)>& evaluate,
    Eigen::VectorXd& x, const DescentOptions& options = {}) {
  Residuals at, there;
  if (!evaluate(x, at)) return {.cost = HUGE_VAL};
  Eigen::VectorXd moved;
  const auto try_step = [&](double damping) -> TrialStep {
    moved = x + DampedStep(at.J.transpose() * at.J, at.J.transpose() * at.r, damping);
    if (!moved.allFinite() || !evaluate(moved, there)) return {};
    return {.cost = there.r.squaredNorm()};
  };
  const auto accept = [&] {
    x = moved;
    std::swap(at, there);
  };
  return Descend(at.r.squaredNorm(), try_step, accept, options);
}

TEST(LevenbergMarquardt, FindsRosenbrocksMinimum) {
  const auto rosenbrock = [](const Eigen::VectorXd& x, Residuals& at) {
    at.r = Eigen::Vector2d(10 * (x[1] - x[0] * x[0]), 1 - x[0]);
    at.J = Eigen::Matrix2d{{-20 * x[0], 10}, {-1, 0}};
    return true;
  };
  Eigen::VectorXd x = Eigen::Vector2d(-1.2, 1.0);
  const DescentResult result = MinimiseSquares(rosenbrock, x, {.relative_gain = 1e-20});
  EXPECT_TRUE(result.settled);
  EXPECT_LT(result.tried, 60);
  EXPECT_NEAR(x[0], 1.0, 1e-9);
  EXPECT_NEAR(x[1], 1.0, 1e-9);
}

TEST(LevenbergMarquardt, FindsBardsMinimum) {
  const double y[15] = {0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39,
                        0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39};
  const auto bard = [&](const Eigen::VectorXd& x, Residuals& at) {
    at.r.resize(15);
    at.J.resize(15, 3);
    for (int i = 0; i < 15; ++i) {
      const double u = i + 1, v = 15 - i, w = std::min(u, v), below = v * x[1] + w * x[2];
      at.r[i] = y[i] - (x[0] + u / below);
      at.J.row(i) << -1, u * v / (below * below), u * w / (below * below);
    }
    return true;
  };
  Eigen::VectorXd x = Eigen::Vector3d::Ones();
  const DescentResult result = MinimiseSquares(bard, x, {.relative_gain = 1e-16});
  EXPECT_TRUE(result.settled);
  EXPECT_NEAR(result.cost, 8.21487e-3, 1e-8);
}

// Powell's singular function: the Jacobian has no full rank at the minimum.
TEST(LevenbergMarquardt, GoesDownWhereTheMinimumIsSingular) {
  const auto powell = [](const Eigen::VectorXd& x, Residuals& at) {
    const double a = x[1] - 2 * x[2], b = x[0] - x[3], five = std::sqrt(5.0), ten = std::sqrt(10.0);
    at.r = Eigen::Vector4d(x[0] + 10 * x[1], five * (x[2] - x[3]), a * a, ten * b * b);
    at.J = Eigen::Matrix4d{{1, 10, 0, 0},
                           {0, 0, five, -five},
                           {0, 2 * a, -4 * a, 0},
                           {2 * ten * b, 0, 0, -2 * ten * b}};
    return true;
  };
  Eigen::VectorXd x = Eigen::Vector4d(3, -1, 0, 1);
  const DescentResult result = MinimiseSquares(powell, x, {.relative_gain = 1e-30});
  EXPECT_LT(result.cost, 1e-16);
}

TEST(LevenbergMarquardt, NeverGoesUpAndStaysOutOfWhereThereIsNothing) {
  double last = HUGE_VAL;
  const auto log_of_x = [&](const Eigen::VectorXd& x, Residuals& at) {
    if (x[0] <= 0) return false;
    at.r = Eigen::VectorXd::Constant(1, std::log(x[0]) - 3);
    at.J = Eigen::MatrixXd::Constant(1, 1, 1 / x[0]);
    return true;
  };
  Eigen::VectorXd x = Eigen::VectorXd::Constant(1, 500.0);  // a plain step lands below zero
  Residuals at;
  const DescentResult result = MinimiseSquares(
      [&](const Eigen::VectorXd& place, Residuals& there) {
        const bool ok = log_of_x(place, there);
        if (ok) last = std::min(last, there.r.squaredNorm());
        return ok;
      },
      x, {.relative_gain = 1e-20});
  EXPECT_NEAR(x[0], std::exp(3.0), 1e-6);
  ASSERT_TRUE(log_of_x(x, at));
  EXPECT_DOUBLE_EQ(result.cost, at.r.squaredNorm());
  EXPECT_DOUBLE_EQ(result.cost, last);
}

TEST(LevenbergMarquardt, DoesNothingWhereTheStartHasNoResiduals) {
  Eigen::VectorXd x = Eigen::Vector2d(1, 2);
  const auto nothing = [](const Eigen::VectorXd&, Residuals&) { return false; };
  const DescentResult result = MinimiseSquares(nothing, x);
  EXPECT_FALSE(result.settled);
  EXPECT_EQ(result.tried, 0);
  EXPECT_EQ(x[1], 2.0);
}

// The scale of an unknown must not matter: metres, radians and pixels stand beside each other.
TEST(LevenbergMarquardt, StepDoesNotDependOnUnits) {
  const Eigen::Matrix2d H{{4, 1}, {1, 3}};
  const Eigen::Vector2d g(1, -2), units(1e-6, 1e3);
  const Eigen::VectorXd plain = DampedStep(H, g, 0.1);
  const Eigen::MatrixXd H_units = units.asDiagonal() * H * units.asDiagonal();
  const Eigen::VectorXd scaled = DampedStep(H_units, units.cwiseProduct(g), 0.1);
  EXPECT_NEAR((units.cwiseProduct(scaled) - plain).norm(), 0.0, 1e-12);
  const Eigen::Matrix2d damped = H + 0.1 * Eigen::Matrix2d(H.diagonal().asDiagonal());
  EXPECT_NEAR((damped * plain + g).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace flextip
