// One control cycle without the camera: the step of each controller, the estimate that feeds it,
// and the vote over the sensors. The peer of each line is the straight-shaft step of the same run,
// that of a vote the one over sensors that agree.
#include <benchmark/benchmark.h>

#include "control/controller.h"
#include "core/rotation.h"
#include "estimation/shaft_estimator.h"
#include "pipeline/guard/sensor_vote.h"

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

EstimatorOptions Options() {
  EstimatorOptions options;
  options.instrument = {0.6, 0.00238, 0.304, 0.0};
  options.p_RP = {0.28, 0.0, 0.0};
  return options;
}

/// Wrist orientation, tip by vision and an EM sensor at one moment of a motion.
Measurements Measured(long i) {
  const double phase = 0.1 * static_cast<double>(i);
  RodSolver solver;
  RodProblem problem{0.6,
                     0.304,
                     0.005 * Eigen::Vector3d(std::sin(phase), std::cos(phase), 0.3),
                     Options().p_RP,
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
  return z;
}

/// The fit that feeds the rod controllers.
void EstimatorUpdate(benchmark::State& state) {
  ShaftEstimator estimator(Options());
  long i = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const Measurements z = Measured(i++);
    state.ResumeTiming();
    benchmark::DoNotOptimize(estimator.Update(z));
  }
}
BENCHMARK(EstimatorUpdate);

enum Wrong { kTipAtFirst, kTipStays, kWristStays };

/// The vote over the sensors, with a tip or wrist that is wrong by so many mm: in the first cycle,
/// and where it stays so. The peer is the vote over sensors that agree, 0 mm.
void Vote(benchmark::State& state) {
  SupervisorOptions options;
  options.kind = SupervisionKind::kFull;
  SensorVote vote(Options(), options);
  const auto wrong = static_cast<Wrong>(state.range(1));
  const auto tip = static_cast<std::uint8_t>(1U << static_cast<int>(VotedSensor::kTip));
  TimeNs t_ns = 0;
  long i = 0;
  for (auto _ : state) {
    state.PauseTiming();
    Measurements z = Measured(i++);
    (wrong == kWristStays ? z.p_RW : z.tip->p_RE).z() += 1e-3 * static_cast<double>(state.range(0));
    t_ns += wrong == kTipAtFirst ? 1'000'000'000 : 33'000'000;
    Supervision found;
    state.ResumeTiming();
    benchmark::DoNotOptimize(vote.Vote(t_ns, wrong == kWristStays ? 0 : tip, {}, z, found));
  }
  constexpr const char* kLabels[] = {"tip, first cycle", "tip stays wrong", "wrist stays wrong"};
  state.SetLabel(kLabels[wrong]);
}
BENCHMARK(Vote)->ArgsProduct({{0, 5, 20, 100, 500}, {kTipAtFirst, kTipStays, kWristStays}});

}  // namespace
}  // namespace flextip

BENCHMARK_MAIN();
