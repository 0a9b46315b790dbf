// One warm rod solve with its Jacobian, against the textbook way of doing the same: shooting with
// a fixed-step Runge-Kutta integration and a Jacobian by differences.
#include <benchmark/benchmark.h>

#include "bench/textbook_rod.h"
#include "kinematics/rod.h"

namespace flextip {
namespace {

/// Chapter 4's shaft under a hung mass; the wrist wanders by 2 mm between solves.
RodProblem Chapter4() {
  RodProblem problem;
  problem.length_m = 0.6;
  problem.bending_stiffness_Nm2 = 0.304;
  problem.p_wrist = {0.0, 0.0, 0.0};
  problem.p_port = {0.28, 0.0, 0.0};
  problem.f_tip = {0.0, -2.0, 0.0};
  return problem;
}

RodProblem Wander(RodProblem problem, long i, double step_m) {
  const double phase = 0.1 * static_cast<double>(i);
  problem.p_wrist += step_m / 0.1 * Eigen::Vector3d(0.5 * std::sin(phase), std::cos(phase), 0.3);
  return problem;
}

void WarmRodSolve(benchmark::State& state) {
  RodSolver solver;
  long i = 0;
  int evaluations = 0;
  for (auto _ : state) {
    const RodState rod =
        solver.Solve(Wander(Chapter4(), i++, 1e-6 * static_cast<double>(state.range(0))));
    if (!rod.IsUsable()) state.SkipWithError("not solved");
    evaluations += rod.iterations;
    benchmark::DoNotOptimize(rod);
  }
  state.counters["evaluations"] =
      benchmark::Counter(evaluations, benchmark::Counter::kAvgIterations);
}
BENCHMARK(WarmRodSolve)->Arg(100)->Arg(2000)->ArgName("step_um");

void WarmRodSolveWithWeight(benchmark::State& state) {
  RodSolver solver;
  long i = 0;
  for (auto _ : state) {
    RodProblem problem = Wander(Chapter4(), i++, 2e-3);
    problem.q_weight = {0, 0, -0.34};
    benchmark::DoNotOptimize(solver.Solve(problem));
  }
}
BENCHMARK(WarmRodSolveWithWeight);

void ColdRodSolve(benchmark::State& state) {
  long i = 0;
  for (auto _ : state) {
    RodSolver solver;
    benchmark::DoNotOptimize(solver.Solve(Wander(Chapter4(), i++, 2e-3)));
  }
}
BENCHMARK(ColdRodSolve);

/// The peer, started from the true unknowns of the step before, to the same 1e-9 m.
void TextbookRodSolve(benchmark::State& state) {
  RodSolver start;
  start.Solve(Chapter4());
  TextbookRod textbook;
  long i = 0;
  for (auto _ : state) {
    const bool ok = textbook.Solve(Wander(Chapter4(), i++, 2e-3));
    if (!ok) state.SkipWithError("not solved");
  }
  const RodProblem last = Wander(Chapter4(), i - 1, 2e-3);
  state.counters["tip_error_m"] = (textbook.TipPosition() - RodSolver().Solve(last).tip.p).norm();
}
BENCHMARK(TextbookRodSolve);

}  // namespace
}  // namespace flextip

BENCHMARK_MAIN();
