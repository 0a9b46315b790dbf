// The integrator of the rod and its variations against the same equations in fixed axes, by a
// Runge-Kutta method of many steps.
#include "kinematics/rod/flow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/draw_vector.h"

namespace flextip {
namespace {

/// t, m, P and their variations, which start in the first column of each block.
using State = Eigen::Matrix<double, 9, 8>;

State Rate(const State& x, const Eigen::Vector3d& n, const Eigen::Matrix<double, 3, 7>& dn) {
  const Eigen::Vector3d t = x.block<3, 1>(0, 0), m = x.block<3, 1>(3, 0);
  State rate;
  rate.col(0) << t.cross(m), t.cross(n), t;
  for (int c = 1; c < 8; ++c) {
    const Eigen::Vector3d dt = x.block<3, 1>(0, c), dm = x.block<3, 1>(3, c);
    const Eigen::Vector3d force = dn.col(c - 1);
    rate.col(c) << dt.cross(m) + t.cross(dm), dt.cross(n) + t.cross(force), dt;
  }
  return rate;
}

/// Walks by the classic method of fourth order.
State RungeKutta(State x, const RodForce& force, const Eigen::Matrix<double, 3, 7>& dn,
                 double length, int steps) {
  const double h = length / steps;
  for (int i = 0; i < steps; ++i) {
    const auto n = [&](double part) -> Eigen::Vector3d {
      return force.n0 + h * (i + part) * force.q;
    };
    const State a = Rate(x, n(0.0), dn), b = Rate(x + 0.5 * h * a, n(0.5), dn);
    const State c = Rate(x + 0.5 * h * b, n(0.5), dn), d = Rate(x + h * c, n(1.0), dn);
    x += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  }
  return x;
}

/// Starts and loads from light to far beyond what a shaft bears.
class RodFlow : public testing::TestWithParam<double> {};

TEST_P(RodFlow, StatesAndVariationsAgainstRungeKutta) {
  const double load = GetParam();
  std::mt19937_64 rng(41);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double state_error = 0.0, variation_error = 0.0;
  for (int i = 0; i < 20; ++i) {
    RodPoint point;
    point.t = DrawVector<3>(uniform, rng).normalized();
    point.y = DrawVector<3>(uniform, rng);
    point.MakeOrthonormal();
    point.m = point.Across() * std::sqrt(load) * DrawVector<2>(uniform, rng);
    RodForce force{load * DrawVector<3>(uniform, rng), Eigen::Vector3d::Zero()};
    if (i % 2 == 1) force.q = load * DrawVector<3>(uniform, rng);
    const double length = 0.6 + 0.3 * uniform(rng);

    // The columns of the map, then those of the force.
    State x = State::Zero();
    x.col(0) << point.t, point.m, Eigen::Vector3d::Zero();
    x.block<3, 2>(0, 1) = point.Across();
    const Eigen::Matrix4d unit = Eigen::Matrix4d::Identity();
    x.block<3, 4>(3, 1) = point.MomentChange<4>(unit);
    Eigen::Matrix<double, 3, 7> dn = Eigen::Matrix<double, 3, 7>::Zero();
    dn.rightCols<3>().setIdentity();
    const State end = RungeKutta(x, force, dn, length, 4000);

    RodMap map;
    ASSERT_TRUE(Advance(length, force, point, &map));
    Eigen::Matrix<double, 9, 1> state;
    state << point.t, point.m, point.P;
    state_error = std::max(state_error, (state - end.col(0)).norm() / end.col(0).norm());
    Eigen::Matrix<double, 4, 7> uv;
    uv << map.flow, map.FlowByForce();
    Eigen::Matrix<double, 9, 7> variations;
    variations << point.Across() * uv.topRows<2>(), point.MomentChange<7>(uv), map.way,
        map.way_by_force;
    variation_error =
        std::max(variation_error, (variations - end.rightCols<7>()).norm() / variations.norm());
  }
  std::printf("states %.1e, variations %.1e\n", state_error, variation_error);
  EXPECT_LT(state_error, 1e-11);
  EXPECT_LT(variation_error, 1e-11);
}
INSTANTIATE_TEST_SUITE_P(Loads, RodFlow, testing::Values(0.1, 1.0, 5.0, 20.0));

}  // namespace
}  // namespace flextip
