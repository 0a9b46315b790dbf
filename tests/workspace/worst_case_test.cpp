// The search for the worst error against all errors of a fine grid.
#include "workspace/worst_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "draw.h"

namespace flextip {
namespace {

/// The measure with these errors; infinite (pi) where the believed shaft does not reach the port.
template <int N>
double ValueAt(const MapSetup<N>& setup, const TrueState<N>& state, const BeliefError<N>& error,
               Measure measure) {
  const auto belief = Believe(setup.truth, error, state.theta);
  const bool angle = measure == Measure::kAngle;
  if (!belief || !belief->Reaches()) {
    return angle ? std::numbers::pi : std::numeric_limits<double>::infinity();
  }
  return angle ? FindLargestAngle(state.J, belief->J_hat).phi_max_rad
               : FindStepError(state.J, belief->J_hat, setup.gain).norm;
}

/// Over a grid of the box or ball in the first `count` components given in `index`.
template <int N>
double BruteForce(const MapSetup<N>& setup, const TrueState<N>& state, const ErrorBounds<N>& bounds,
                  Measure measure, const std::vector<int>& index, int steps) {
  double worst = 0.0;
  std::vector<int> at(index.size(), 0);
  for (bool more = true; more;) {
    Eigen::VectorXd x(index.size());
    for (std::size_t k = 0; k < at.size(); ++k) x[int(k)] = 2.0 * at[k] / steps - 1.0;
    if (bounds.shape == BoundShape::kEllipsoid && x.norm() > 1.0) x.normalize();
    auto v = setup.error.AsVector();
    for (std::size_t k = 0; k < at.size(); ++k)
      v[index[k]] += bounds.half_width.AsVector()[index[k]] * x[int(k)];
    worst = std::max(worst, ValueAt(setup, state, BeliefError<N>::FromVector(v), measure));
    more = false;
    for (auto& i : at) {
      if (++i <= steps) {
        more = true;
        break;
      }
      i = 0;
    }
  }
  return worst;
}

/// Never below the grid's worst by more than rounding, and above it only by what the grid's
/// coarseness explains.
template <int N>
void Check(const ErrorBounds<N>& bounds, const std::vector<int>& index, int steps,
           double coarseness, int states, unsigned seed) {
  std::mt19937_64 rng(seed);
  const MapSetup<N> setup{.truth = {}};
  for (int i = 0; i < states; ++i) {
    const auto state = DrawState(setup.truth, rng);
    for (const Measure measure : {Measure::kNorm, Measure::kAngle}) {
      const double brute = BruteForce(setup, state, bounds, measure, index, steps);
      const auto worst = FindWorst(setup, state, bounds, measure);
      EXPECT_GE(worst.value, brute * (1.0 - 1e-7)) << i;
      EXPECT_LE(worst.value, brute * (1.0 + coarseness)) << i;
      const auto sum = BeliefError<N>::FromVector(setup.error.AsVector() + worst.error.AsVector());
      EXPECT_DOUBLE_EQ(worst.value, ValueAt(setup, state, sum, measure));
    }
  }
}

TEST(WorstCase, OfAPortInABox) {
  Check<2>({.half_width = {.port_m = {0.01, 0.006}}}, {0, 1}, 60, 1e-6, 200, 1);
}
TEST(WorstCase, OfAPortInAnEllipse) {
  Check<2>({.half_width = {.port_m = {0.01, 0.006}}, .shape = BoundShape::kEllipsoid}, {0, 1}, 100,
           0.01, 100, 2);
}
TEST(WorstCase, OfPortJointsAndShaftInABox) {
  Check<2>({.half_width = {.port_m = {0.005, 0.005}, .joints_rad = {0.02, 0.0}, .shaft_m = 0.004}},
           {0, 1, 4, 6}, 8, 1e-6, 40, 3);
}
TEST(WorstCase, OfAPortInABallInSpace) {
  Check<3>({.half_width = {.port_m = {0.008, 0.008, 0.008}}, .shape = BoundShape::kEllipsoid},
           {0, 1, 2}, 16, 0.03, 20, 4);
}

TEST(WorstCase, IsHopelessWhereASingularJacobianMayBeBelieved) {
  const MapSetup<2> setup{.truth = {}};
  TrueShaft<2> shaft(setup.truth, std::nullopt);
  const auto near_port = shaft.AtTip({0.16, -0.006});
  ASSERT_TRUE(near_port);
  const ErrorBounds<2> bounds{.half_width = {.port_m = {0.01, 0.01}}};
  EXPECT_EQ(FindWorst(setup, *near_port, bounds, Measure::kNorm).value,
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(FindWorst(setup, *near_port, bounds, Measure::kAngle).value, std::numbers::pi);
  EXPECT_LT(FindWorst(setup, *near_port, bounds, Measure::kNorm, 0.1).value, 10.0);
}

TEST(WorstCase, IsZeroWithoutErrorsAndNotANumberOffTheWorkspace) {
  const MapSetup<2> setup{.truth = {}};
  const auto map = ComputeMap(setup, {}, 0.03);
  const auto worst = WorstOverMap(setup, map, ErrorBounds<2>{}, Measure::kNorm);
  ASSERT_EQ(worst.size(), map.points.size());
  for (std::size_t i = 0; i < worst.size(); ++i) {
    if (map.points[i].state) {
      EXPECT_LT(worst[i], 1e-10);
    } else {
      EXPECT_TRUE(std::isnan(worst[i]));
    }
  }
}

}  // namespace
}  // namespace flextip
