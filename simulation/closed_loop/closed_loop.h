// The closed loop: plant -> sensors (and laparoscope -> vision) -> estimation -> control -> wrist.
// Estimator and controller get the sensors' readings and nothing else.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "control/controller.h"
#include "control/direction_controller.h"
#include "control/fixtures.h"
#include "control/supervision/stops.h"
#include "control/supervision/supervisor_options.h"
#include "control/tip_path.h"
#include "core/image.h"
#include "estimation/instrument_model.h"
#include "estimation/shaft_estimator.h"
#include "estimation/watch/instrument_watch.h"
#include "pipeline/instrument_controller.h"
#include "recording/recording.h"
#include "recording/truth.h"
#include "simulation/faults/fault.h"
#include "simulation/plant/plant.h"
#include "simulation/render/laparoscope.h"
#include "simulation/sensors/sensors.h"
#include "simulation/virtual_robot/wrist_servo.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip::simulation {

struct LoopCycle;  // loop_table.h

/// What sets in while a run goes on: from then on plant and sensors have these effects.
struct EffectsOnset {
  double t_s = 0.0;  ///< since the run's begin
  PlantEffects plant;
  SensorEffects sensors;
};

struct LoopSetup {
  Recording base;  ///< instrument, registered port, gravity, camera and collar; no samples
  PlantSetup plant;
  PlantOptions plant_options;
  Eigen::Vector3d p_RW_start = Eigen::Vector3d::Zero();
  WristServoSetup servo;
  SensorSetup sensors;
  SensorEffects sensor_effects;
  /// Makes the found model that estimator and controller know of; empty: none. The plant does not
  /// know it. Called for each run, perhaps by several at once.
  std::function<std::unique_ptr<InstrumentModel>()> model;
  /// Makes what looks for causes while the loop runs; empty: nothing does.
  std::function<std::unique_ptr<InstrumentWatch>()> watch;
  std::optional<EffectsOnset> onset;
  double update_rate_hz = 30.0;  ///< of the controller
  /// What the controller is told of the tip's and em0's latencies: `sensor_effects` makes them.
  Latency tip_latency, em0_latency;
  PathSetup path;
  ControllerOptions controller;
  std::optional<DirectionOptions> direction;  ///< where the path's waypoints have directions
  Eigen::Vector3d direction_free_axis = Eigen::Vector3d::Zero();
  Fixtures fixtures;
  double port_prior_m = kPortRegistration_m;
  SupervisorOptions supervision;
  std::vector<Fault> faults;
  std::uint64_t fault_seed = 1;  ///< of the faults' directions and chances
  /// A person lets a faulted loop go on at this time of the run and each second after it; empty:
  /// never.
  std::optional<double> resume_s;
  double max_s = 0.0;  ///< the run ends here, reached or not; 0: at the path's end
  std::uint64_t seed = 1;
  /// Is given every cycle; empty: nobody.
  std::function<void(const LoopCycle&)> note_cycle;
};

/// For rendered runs. `save` is given every frame as the camera made it.
struct LoopCamera {
  const Laparoscope& laparoscope;
  TrackerOptions tracker;
  std::function<void(TimeNs, const Image&)> save;
};

/// One update, for scoring and pictures.
struct LoopUpdate {
  TimeNs t_ns = 0;
  Eigen::Vector3d p_RE_desired = Eigen::Vector3d::Zero();  ///< as the fixtures left it
  Eigen::Vector3d p_RE = Eigen::Vector3d::Zero();          ///< true
  double deviation_m = 0.0;                                ///< of the true tip from the path
  ControlStatus status = ControlStatus::kOk;
  std::optional<TipObservation> tip;  ///< as the controller had it, carried on to now where late
  Supervision supervision;
  FoundCause cause;                                        ///< by the watch
  bool resumed = false;                                    ///< a person said so in this cycle
  Eigen::Vector3d p_RW = Eigen::Vector3d::Zero();          ///< by the encoders, without noise
  Eigen::Vector3d p_RW_command = Eigen::Vector3d::Zero();  ///< perhaps not finite
  Eigen::Vector3d f_tip_N = Eigen::Vector3d::Zero();       ///< true
};

struct LoopResult {
  Recording recording;
  Series<TruthSample> truth;
  std::vector<LoopUpdate> updates;
  double max_deviation_m = 0.0, rms_deviation_m = 0.0;
  double final_error_m = 0.0;              ///< of the true tip from the last waypoint
  double final_direction_error_rad = 0.0;  ///< where the path has directions
  double gain = 0.0;                       ///< of the controller, as far as latencies let it
  std::map<std::string, int> control_statuses, tip_statuses;
  std::map<std::string, int> fixture_statuses;  ///< empty without fixtures
  int steps_limited = 0, steps_damped = 0;
  /// With faults, why the shaft has no equilibrium any more, where the run ended so.
  std::string lost_equilibrium;
};

/// Returns the warnings of the run: a row each time that other causes were named.
std::vector<Warning> WarningsOf(const LoopResult& result);

/// Returns what the controller of a run is made of, and the tracker of recordings for `camera`;
/// null without one: the tip's sensor is then simulated by its figures.
InstrumentControllerOptions ControllerOptionsOf(const LoopSetup& setup);
std::unique_ptr<InstrumentTracker> TrackerOf(const LoopSetup& setup, const TrackerOptions* camera);

/// Takes the latencies that the controller is told of off the times of its inputs, pictures
/// included.
void TakeOffLatencies(const LoopSetup& setup, ControllerInputs& inputs);

/// Runs one controller along the path. `camera` null: the tip comes from `sensors.tip` instead.
/// The goal waits while the supervisor holds the wrist. Throws InputError where the plant has no
/// equilibrium at the start, and for faults of the tip with a camera; WorkError where the plant
/// loses its equilibrium without a fault.
LoopResult RunClosedLoop(const LoopSetup& setup, const LoopCamera* camera,
                         const std::function<void(int done, int total)>& progress = {});

}  // namespace flextip::simulation
