// One warm solve of the rod with effects, with its derivatives by all 25 inputs at wrist, tip and
// three stations, against the plain rod's solve.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>

#include "kinematics/effect_rod.h"
#include "kinematics/rod.h"

namespace flextip {
namespace {

EffectRodProblem Laden(double load, bool with_effects) {
  EffectRodProblem problem;
  problem.rod = {0.6, 0.304, {0, 0, 0}, {0.28, 0, 0}, {0.1, -load, 0.1}, {0, 0, -0.34}};
  if (!with_effects) return problem;
  problem.effects.curvature_1_m = {0.1, -0.2};
  problem.effects.port_compliance_m_N = 3e-4;
  problem.effects.wrist_compliance_m_N = 1e-4;
  problem.effects.port_couple_Nm = {0.02, 0.05, 0.0};
  problem.effects.port_friction = -0.2;
  problem.effects.q_inside_N_m = {0.0, 0.3, 0.2};
  return problem;
}

Eigen::Vector3d Wander(long i, double step_m) {
  const double phase = 0.1 * static_cast<double>(i);
  return step_m / 0.1 * Eigen::Vector3d(0.5 * std::sin(phase), std::cos(phase), 0.3);
}

void WarmSolve(benchmark::State& bench, const EffectRodProblem& start, double step_m) {
  const std::array<RodStation, 3> stations{{{0.1, false}, {0.1, true}, {0.2, false}}};
  EffectRodSolver solver;
  long i = 0, evaluations = 0;
  for (auto _ : bench) {
    EffectRodProblem problem = start;
    problem.rod.p_wrist += Wander(i++, step_m);
    const EffectRodState state = solver.Solve(problem, stations);
    if (!state.IsUsable()) bench.SkipWithError("not solved");
    evaluations += state.iterations;
    benchmark::DoNotOptimize(state.tip.dp(0, 0));
  }
  bench.counters["evaluations"] =
      benchmark::Counter(static_cast<double>(evaluations), benchmark::Counter::kAvgIterations);
}
BENCHMARK_CAPTURE(WarmSolve, plain_100um, Laden(0.5, false), 1e-4);
BENCHMARK_CAPTURE(WarmSolve, effects_100um, Laden(0.5, true), 1e-4);
BENCHMARK_CAPTURE(WarmSolve, effects_2mm, Laden(0.5, true), 2e-3);
BENCHMARK_CAPTURE(WarmSolve, heavy_effects_100um, Laden(2.0, true), 1e-4);
BENCHMARK_CAPTURE(WarmSolve, heavy_effects_2mm, Laden(2.0, true), 2e-3);

void ColdSolve(benchmark::State& bench) {
  for (auto _ : bench) {
    EffectRodSolver solver;
    benchmark::DoNotOptimize(solver.Solve(Laden(2.0, true)).iterations);
  }
}
BENCHMARK(ColdSolve);

/// The plain rod with its nine columns, for comparison.
void PlainRod(benchmark::State& bench) {
  const RodProblem start = Laden(2.0, false).rod;
  RodSolver solver;
  long i = 0;
  for (auto _ : bench) {
    RodProblem problem = start;
    problem.p_wrist += Wander(i++, 1e-4);
    const RodState state = solver.Solve(problem);
    if (!state.IsUsable()) bench.SkipWithError("not solved");
    benchmark::DoNotOptimize(state.tip.dp(0, 0));
  }
}
BENCHMARK(PlainRod);

}  // namespace
}  // namespace flextip

BENCHMARK_MAIN();
