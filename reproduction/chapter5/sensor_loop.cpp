#include "reproduction/chapter5/sensor_loop.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "control/tip_path.h"
#include "pipeline/instrument_controller.h"
#include "simulation/plant/plant.h"
#include "simulation/sensors/sensors.h"

namespace flextip::reproduction {
namespace {

// The press of the demo (testdata/scenarios/press.yaml).
const Instrument kInstrument{0.6, 0.00238, 0.304, 0.0};
const Eigen::Vector3d kPort(0.0, 0.0, 0.17), kWrist(-0.2457, 0.0, 0.3421);
const Eigen::Vector3d kSurface(0.2457, 0.0, -0.0021);
const Eigen::Vector3d kPortOff = Eigen::Vector3d(0.3, 0.8, 0.5).normalized();
const Eigen::Vector3d kHung(0.25, -0.2, 0.45);  // N
constexpr double kRate_hz = 30.0, kEmFromTip_m = 0.02, kWander_m = 0.008;
constexpr int kWanderUpdates = 30;

simulation::SensorSetup AllSensors() {
  simulation::SensorSetup setup;
  setup.wrist.emplace();
  setup.wrist->rate_hz = kRate_hz;
  setup.wrist->position_noise_m = 0.00005;
  setup.wrist->orientation_noise_rad = 0.0003;
  setup.em0.emplace();
  setup.em0->rate_hz = kRate_hz;
  setup.em0->distance_from_tip_m = kEmFromTip_m;
  setup.em0->position_noise_m = 0.00013;
  setup.em0->orientation_noise_rad = 0.00056;
  setup.strain.emplace();
  setup.strain->rate_hz = kRate_hz;
  setup.strain->station_from_wrist_m[0] = 0.15;
  setup.strain->station_from_wrist_m[1] = 0.5;
  setup.strain->moment_noise_Nm = 0.0008;
  setup.load.emplace();
  setup.load->rate_hz = kRate_hz;
  setup.load->force_noise_N = 0.005;
  setup.tip.emplace();
  setup.tip->rate_hz = kRate_hz;
  setup.tip->depth_noise_m = 0.0006;
  setup.tip->line_of_sight = Eigen::Vector3d(-0.27, 0.73, -0.63).normalized();
  return setup;
}

simulation::PlantSetup MakePlant(const SensorCase& setup) {
  simulation::PlantSetup plant;
  plant.instrument = kInstrument;
  plant.p_RP = kPort + setup.port_off_m * kPortOff;
  if (setup.move == SensorMove::kLateral) {
    plant.load.constant_N = kHung;
    return plant;
  }
  simulation::Tissue tissue;
  tissue.p_surface = tissue.p_anchor = kSurface;
  tissue.stiffness_N_m = 50.0;
  tissue.tangential_stiffness_N_m = 4.0;
  plant.load.tissue = tissue;
  return plant;
}

PathSetup MakePath(SensorMove move) {
  PathSetup path;
  path.speed_m_s = 0.015;
  path.settle_s = 0.3;
  if (move == SensorMove::kPress) path.waypoints_m = {{0.0, 0.0, -0.01}};
  if (move == SensorMove::kLateral) path.waypoints_m = {{0.002, 0.009, -0.004}};
  return path;
}

ControllerKind KindFor(const SensorCase& setup) {
  const bool sees = setup.sensors.SeesTip();
  switch (setup.model) {
    case SensorModel::kStraight:
      return sees ? ControllerKind::kStraightTrack : ControllerKind::kStraightCalculate;
    case SensorModel::kFlex:
      return sees ? ControllerKind::kFlexTrack : ControllerKind::kFlexCalculate;
    case SensorModel::kRod:
      break;
  }
  return sees ? ControllerKind::kRodTrack : ControllerKind::kRodCalculate;
}

InstrumentControllerOptions MakeController(const SensorCase& setup) {
  InstrumentControllerOptions options;
  options.estimator =
      EstimatorOptionsFor(kInstrument, kPort, Eigen::Vector3d::Zero(), setup.port_prior_m);
  options.window_samples = setup.window ? WindowOptions().samples : 0;
  options.control.kind = KindFor(setup);
  options.control.max_step_m = 0.02;
  options.em_is_tip = true;
  options.straight_at_registered_port = true;
  return options;
}

/// The newest samples of the sensors in the set.
SensorReadings ReadingsOf(const Recording& recording, const SensorSet& sensors) {
  SensorReadings readings = NewestReadings(recording);
  readings.em1.reset();
  if (!sensors.tip) readings.tip.reset();
  if (readings.tip && !sensors.tip_direction) readings.tip->value.tip.d_RE.reset();
  if (!sensors.em_position && !sensors.em_direction) readings.em0.reset();
  if (readings.em0 && !sensors.em_position)
    readings.em0->value.position_noise_m = 1e3;  // its position says nothing
  if (!sensors.strain) readings.strain.reset();
  if (!sensors.load) readings.load.reset();
  return readings;
}

class SensorLoop {
 public:
  explicit SensorLoop(const SensorCase& setup)
      : setup_(setup),
        plant_(MakePlant(setup), {.links_before_port = 60, .links_behind_port = 60}),
        sensors_(AllSensors(), setup.seed),
        controller_(MakeController(setup)) {}

  SensorRun Run() {
    Wander();
    if (run_.lost) return run_;
    std::optional<TipPath> path;
    path.emplace(MakePath(setup_.move), shape_.T_RE(), kRate_hz);
    Eigen::Vector3d p_RW = kWrist;
    while (!path->Done() && Move(p_RW)) {
      const ControllerCommand command = Cycle(path->Advance(Eigen::Vector3d::Zero()));
      Score(command, path->Deviation(shape_.T_RE().p));
      p_RW = command.p_RW_command + (p_RW - command.measurements.p_RW);
    }
    const double count = std::max(1, run_.updates);
    run_.tip_rms_m = std::sqrt(run_.tip_rms_m / count);
    run_.path_rms_m = std::sqrt(run_.path_rms_m / count);
    return run_;
  }

 private:
  /// Three slow sines that end where they began.
  void Wander() {
    for (int i = 0; i <= kWanderUpdates && !run_.lost; ++i) {
      const double turn = 2.0 * 3.14159265358979 * i / kWanderUpdates;
      const Eigen::Vector3d away(std::sin(turn), std::sin(2.0 * turn), std::sin(3.0 * turn));
      if (Move(kWrist + kWander_m * away)) Cycle({});
    }
  }

  bool Move(const Eigen::Vector3d& p_RW) {
    shape_ = plant_.Solve(p_RW);
    run_.lost = !shape_.IsUsable();
    return !run_.lost;
  }

  /// Without a goal the cycle only watches.
  ControllerCommand Cycle(const std::optional<Eigen::Vector3d>& p_RE_desired) {
    ControllerInputs inputs;
    inputs.t_ns = simulation::kSimulationStart_ns + std::llround(tick_++ * 1e9 / kRate_hz);
    sensors_.Sample(shape_, inputs.t_ns, recording_);
    inputs.sensors = ReadingsOf(recording_, setup_.sensors);
    inputs.p_RE_desired = p_RE_desired;
    return controller_.Step(inputs);
  }

  void Score(const ControllerCommand& command, double deviation_m) {
    ++run_.updates;
    run_.without_model += command.status != ControlStatus::kOk;
    run_.tip_rms_m += (command.p_RE_used - shape_.T_RE().p).squaredNorm();
    run_.path_rms_m += deviation_m * deviation_m;
    run_.path_max_m = std::max(run_.path_max_m, deviation_m);
  }

  SensorCase setup_;
  simulation::Plant plant_;
  simulation::Sensors sensors_;
  InstrumentController controller_;
  Recording recording_;
  simulation::PlantShape shape_;
  SensorRun run_;
  int tick_ = 0;
};

}  // namespace

SensorRun RunSensorCase(const SensorCase& setup) { return SensorLoop(setup).Run(); }

}  // namespace flextip::reproduction
