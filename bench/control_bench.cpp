// One control cycle without the camera: the step of each controller, and the estimate that feeds
// it. The peer of each line is the straight-shaft step of the same run.
#include <benchmark/benchmark.h>

#include "control/controller.h"
#include "core/rotation.h"
#include "estimation/shaft_estimator.h"

namespace flextip {
namespace {

ControlInput Input() {
  ControlInput input;
  input.model.instrument = {0.6, 0.00238, 0.304, 0.0};
  input.model.p_RP = {0.28, 0.0, 0.0};
  input.model.f_tip_N = {0.0, -2.0, 0.0};
  input.model.force_known = true;
  input.model.tissue_stiffness_N_m = -50.0 * Eigen::Matrix3d::Identity();
  input.model.beam = SolveBeam(input.p_RW, input.model.p_RP, input.model.f_tip_N, 0.304, 0.6);
  input.p_RE_measured = {0.57, -0.12, 0.0};
  input.tip_measured = true;
  return input;
}

void ControlStep(benchmark::State& state) {
  ControllerOptions options;
  options.kind = static_cast<ControllerKind>(state.range(0));
  TipController controller(options);
  ControlInput input = Input();
  long i = 0;
  for (auto _ : state) {
    const double phase = 0.1 * static_cast<double>(i++);
    input.p_RW = 0.005 * Eigen::Vector3d(std::sin(phase), std::cos(phase), 0.3);
    input.p_RE_desired = input.p_RE_measured + Eigen::Vector3d(0.0005, 0.0003, -0.0002);
    benchmark::DoNotOptimize(controller.Step(input));
  }
  state.SetLabel(Name(options.kind));
}
BENCHMARK(ControlStep)->DenseRange(0, kControllerKinds - 1);

/// Wrist orientation, tip by vision and an EM sensor: the fit that feeds the rod controllers.
void EstimatorUpdate(benchmark::State& state) {
  EstimatorOptions options;
  options.instrument = {0.6, 0.00238, 0.304, 0.0};
  options.p_RP = {0.28, 0.0, 0.0};
  ShaftEstimator estimator(options);
  RodSolver solver;
  long i = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const double phase = 0.1 * static_cast<double>(i++);
    RodProblem problem{0.6,
                       0.304,
                       0.005 * Eigen::Vector3d(std::sin(phase), std::cos(phase), 0.3),
                       options.p_RP,
                       {0.0, -1.5 - 0.2 * std::sin(phase), 0.2},
                       {0, 0, 0}};
    const RodState rod = solver.Solve(problem);
    const RodSection em = solver.Section(0.58);
    Measurements z;
    z.p_RW = problem.p_wrist;
    z.wrist_position_noise_m = 5e-5;
    z.R_RW = RotationWithoutTwist(Eigen::Vector3d::UnitX(), rod.wrist.t);
    z.wrist_orientation_noise_rad = 3e-4;
    z.tip = TipObservation{TipStatus::kOk, rod.tip.p, 4e-8 * Eigen::Matrix3d::Identity(), {}};
    z.em = EmMeasurement{
        {RotationWithoutTwist(Eigen::Vector3d::UnitX(), em.t), em.p}, 0.02, 1.3e-4, 5.6e-4};
    state.ResumeTiming();
    benchmark::DoNotOptimize(estimator.Update(z));
  }
}
BENCHMARK(EstimatorUpdate);

}  // namespace
}  // namespace flextip

BENCHMARK_MAIN();
