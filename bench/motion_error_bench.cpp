// The error measures of chapter 2 in space: the exact largest angle, the bound, and as their peer
// the search of all directions that the thesis names, at three densities. Pairs of Jacobians with
// errors of 10 % (angles up to 90 degrees) and without any relation (mostly past 90).
#include <benchmark/benchmark.h>

#include <random>
#include <vector>

#include "bench/sphere_search.h"
#include "control/motion_error.h"

namespace flextip {
namespace {

struct Pair {
  Eigen::Matrix3d J, J_hat;
};

/// 64 pairs; `error` 0 makes them independent.
std::vector<Pair> Pairs(double error) {
  std::mt19937_64 rng(1);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return normal(rng); };
  std::vector<Pair> pairs(64);
  for (Pair& pair : pairs) {
    pair.J = Eigen::Matrix3d::NullaryExpr(draw);
    pair.J_hat = Eigen::Matrix3d::NullaryExpr(draw);
    if (error > 0.0) pair.J_hat = pair.J + error * pair.J.norm() / 3.0 * pair.J_hat;
  }
  return pairs;
}

/// Arguments: error in per cent, then what else the case takes.
double Error(const benchmark::State& state) { return 0.01 * static_cast<double>(state.range(0)); }

void LargestAngleExact(benchmark::State& state) {
  const std::vector<Pair> pairs = Pairs(Error(state));
  std::size_t i = 0;
  for (auto _ : state) {
    const Pair& pair = pairs[i++ % pairs.size()];
    benchmark::DoNotOptimize(FindLargestAngle(pair.J, pair.J_hat));
  }
}
BENCHMARK(LargestAngleExact)->Arg(10)->Arg(0);

/// ||G||, v_sigma and phi_hat_max.
void StepErrorAndBound(benchmark::State& state) {
  const std::vector<Pair> pairs = Pairs(Error(state));
  std::size_t i = 0;
  for (auto _ : state) {
    const Pair& pair = pairs[i++ % pairs.size()];
    benchmark::DoNotOptimize(FindStepError(pair.J, pair.J_hat));
  }
}
BENCHMARK(StepErrorAndBound)->Arg(10)->Arg(0);

void LargestAnglePlane(benchmark::State& state) {
  const std::vector<Pair> pairs = Pairs(Error(state));
  std::size_t i = 0;
  for (auto _ : state) {
    const Pair& pair = pairs[i++ % pairs.size()];
    const Eigen::Matrix2d J = pair.J.topLeftCorner<2, 2>(),
                          J_hat = pair.J_hat.topLeftCorner<2, 2>();
    benchmark::DoNotOptimize(FindLargestAngle(J, J_hat));
  }
}
BENCHMARK(LargestAnglePlane)->Arg(10)->Arg(0);

/// The peer. Second argument: steps on a quarter circle. `missed` is the part of the pairs whose
/// angle it does not find to 1e-9 rad.
void LargestAngleBySearch(benchmark::State& state) {
  const std::vector<Pair> pairs = Pairs(Error(state));
  std::vector<double> grid;
  std::size_t i = 0;
  double missed = 0.0, searched = 0.0;
  for (auto _ : state) {
    const Pair& pair = pairs[i++ % pairs.size()];
    MotionPair<3> map;
    map.T = pair.J * pair.J_hat.inverse();
    const double angle = SearchSphere(map, static_cast<int>(state.range(1)), grid).angle;
    benchmark::DoNotOptimize(angle);
    state.PauseTiming();
    searched += 1.0;
    if (angle < FindLargestAngle(pair.J, pair.J_hat).phi_max_rad - 1e-9) missed += 1.0;
    state.ResumeTiming();
  }
  state.counters["missed"] = missed / searched;
}
BENCHMARK(LargestAngleBySearch)
    ->ArgsProduct({{10, 0}, {90, 360, 900}})
    ->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace flextip

BENCHMARK_MAIN();
