#include "reproduction/chapter5/setup.h"

#include <cmath>

namespace flextip::reproduction {
namespace {

constexpr double kTick_hz = 144.0;  // the plant is solved at least as often

/// The camera of 5.2.6 stands 360 mm behind and 890 mm above the robot and looks at the dish.
Eigen::Vector3d LineOfSight(const TrialPlaces& places) {
  return Eigen::Vector3d(places.surface_x_m + 0.36, 0.0, -0.89).normalized();
}

}  // namespace

Instrument Rod() { return {0.6, 0.00238, 0.304, 0.0351}; }

double TickRate(const TrialSetup& setup) {
  return setup.update_rate_hz * std::ceil(kTick_hz / setup.update_rate_hz - 1e-9);
}

simulation::SensorSetup MakeSensors(const TrialSetup& setup, const TrialPlaces& places) {
  simulation::SensorSetup sensors;
  const double rate = TickRate(setup);
  sensors.wrist.emplace();
  sensors.wrist->rate_hz = rate;
  sensors.wrist->position_noise_m = kEncoderNoise_m;
  sensors.wrist->orientation_noise_rad = setup.em_orientation_noise_rad;
  sensors.em0.emplace();
  sensors.em0->rate_hz = rate;
  sensors.em0->distance_from_tip_m = kSensorFromTip_m;
  sensors.em0->position_noise_m = setup.em_position_noise_m;
  sensors.em0->orientation_noise_rad = setup.em_orientation_noise_rad;
  if (setup.sense == TipSense::kVision) {
    sensors.tip.emplace();
    sensors.tip->rate_hz = setup.update_rate_hz;
    sensors.tip->line_of_sight = LineOfSight(places);
  }
  return sensors;
}

EstimatorOptions MakeEstimator(const TrialSetup& setup, const TrialPlaces& places) {
  EstimatorOptions options = EstimatorOptionsFor(Rod(), places.p_RP, kGravity);
  options.use_positions = UsesTipMeasurement(setup.kind);
  options.estimate_tissue = setup.tissue_response;
  return options;
}

ControllerOptions MakeController(const TrialSetup& setup) {
  ControllerOptions options;
  options.kind = setup.kind;
  options.beam_load_law = BeamLoadLaw::kPortForce;  // as the thesis assumes
  return options;
}

simulation::OperatorTask MakeTask(const TrialPlaces& places) {
  const Eigen::Vector3d sight = LineOfSight(places);
  simulation::OperatorTask task;
  task.p_centre = {places.WallX(), 0.0, 0.0};
  task.outline_radius_m = places.outline_radius_m;
  task.right = Eigen::Vector3d::UnitY();
  task.up = task.right.cross(sight).normalized();
  if (task.up.z() < 0.0) task.up = -task.up;
  return task;
}

}  // namespace flextip::reproduction
