#include "simulation/closed_loop/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "pipeline/instrument_controller.h"
#include "simulation/closed_loop/loop_table.h"
#include "simulation/faults/plant_faults.h"
#include "simulation/faults/robot_faults.h"
#include "simulation/faults/sensor_faults.h"
#include "simulation/plant/curve_history.h"

namespace flextip::simulation {
namespace {

/// With a camera, the tip is what vision sees, not what a figure says it would.
SensorSetup WithoutTipIf(bool camera, SensorSetup sensors) {
  if (camera) sensors.tip.reset();
  return sensors;
}

/// One run of the loop.
class Loop {
 public:
  Loop(const LoopSetup& setup, const LoopCamera* camera)
      : setup_(setup),
        camera_(camera),
        plant_(setup.plant, setup.plant_options),
        sensors_(WithoutTipIf(camera != nullptr, setup.sensors), setup.seed, setup.sensor_effects),
        controller_(ControllerOptionsOf(setup), setup.model ? setup.model() : nullptr,
                    TrackerOf(setup, camera != nullptr ? &camera->tracker : nullptr),
                    setup.watch ? setup.watch() : nullptr),
        servo_(setup.servo, setup.p_RW_start, setup.seed),
        curves_(setup.sensor_effects.camera_latency_s),
        sensor_faults_(setup.faults, setup.fault_seed),
        plant_faults_(setup.faults, setup.plant, setup.fault_seed),
        robot_faults_(setup.faults, setup.fault_seed),
        p_RW_sent_(setup.p_RW_start) {
    result_.recording = setup.base;
    if (camera_ != nullptr) StartCamera();
    shape_ = plant_.Solve(servo_.p_RW());
    if (!shape_.IsUsable()) {
      throw InputError(
          fmt::format("the shaft has no equilibrium at the start: {}", shape_.message));
    }
    path_.emplace(setup.path, shape_.T_RE(), setup.update_rate_hz);
  }

  LoopResult Run(const std::function<void(int, int)>& progress) {
    const int total = path_->MaxUpdates();
    TimeNs update_ns = UpdateTime(0);
    for (int updates = 0; !IsOver();) {
      t_ns_ = std::min(sensors_.NextDue().value_or(update_ns), update_ns);
      if (t_ns_ > kSimulationStart_ns && !MoveWrist()) break;
      Sense();
      const bool at_update = t_ns_ == update_ns;
      if (at_update) {
        Update();
        update_ns = NextUpdate(updates);
        if (progress) progress(static_cast<int>(result_.updates.size()), total);
      }
      Score(at_update);
    }
    Finish();
    return std::move(result_);
  }

 private:
  /// The controller has its own clock and so has every sensor: the plant is solved where any of
  /// them is due.
  TimeNs UpdateTime(int update) const {
    return kSimulationStart_ns + std::llround(update * 1e9 / setup_.update_rate_hz);
  }

  double Seconds(TimeNs t_ns) const {
    return 1e-9 * static_cast<double>(t_ns - kSimulationStart_ns);
  }

  /// The time of the cycle after `updates`, which is moved on. A late one takes the place of those
  /// that were due before it.
  TimeNs NextUpdate(int& updates) {
    do ++updates;
    while (UpdateTime(updates) <= t_ns_);
    const TimeNs due_ns = UpdateTime(updates);
    return due_ns + std::llround(1e9 * robot_faults_.LateBy(Seconds(due_ns)));
  }

  bool IsOver() const {
    return path_->Done() || (setup_.max_s > 0.0 && Seconds(t_ns_) >= setup_.max_s);
  }

  TimeNs CameraTime(int number) const {
    return kSimulationStart_ns + std::llround(number * 1e9 / setup_.base.cam0->calibration.rate_hz);
  }

  void StartCamera() {
    for (const Fault& fault : setup_.faults) {
      if (fault.stream == FaultStream::kTip)
        throw InputError("faults of the tip need a tip by its figures, not by a camera");
    }
    result_.recording.vision0.emplace();
    result_.recording.vision0->comment = "tip by vision, as the loop saw it";
    result_.recording.vision0->rate_hz = setup_.base.cam0->calibration.rate_hz;
  }

  void SetIn(double t_s) {
    if (has_set_in_ || !setup_.onset || t_s < setup_.onset->t_s) return;
    has_set_in_ = true;
    plant_.SetEffects(setup_.onset->plant);
    sensors_.SetEffects(setup_.onset->sensors);
  }

  /// Returns false where the shaft has no equilibrium any more because of a fault.
  bool MoveWrist() {
    const double t_s = Seconds(t_ns_);
    servo_.SetMaxSpeed(setup_.servo.max_speed_m_s * robot_faults_.SpeedPart(t_s));
    servo_.Advance(t_ns_);
    SetIn(t_s);
    plant_faults_.Act(t_s, shape_, plant_);
    wrist_shift_ = plant_faults_.WristShift(t_s);
    PlantShape shape = plant_.Solve(servo_.p_RW() + wrist_shift_, t_s);
    if (shape.IsUsable()) {
      shape_ = std::move(shape);
      shape_.p_RW_measured = servo_.p_RW();
      return true;
    }
    result_.lost_equilibrium =
        fmt::format("the shaft lost its equilibrium {:.3f} s into the run: {}", t_s, shape.message);
    if (setup_.faults.empty()) throw WorkError(result_.lost_equilibrium);
    return false;
  }

  void Sense() {
    sensors_.Sample(shape_, t_ns_, result_.recording);
    if (camera_ != nullptr) curves_.Add(t_ns_, shape_.Curve());
    result_.truth.push_back(
        {t_ns_, {shape_.T_RE().p, shape_.T_RE().Quaternion(), servo_.p_RW() + wrist_shift_}});
  }

  /// The camera's frame, rendered and kept. With a latency it shows the shaft as it was before.
  Image TakePicture() {
    const int number = static_cast<int>(result_.recording.cam0->filenames.size());
    next_picture_ns_ = CameraTime(number + 1);
    Image frame = camera_->laparoscope.Render(curves_.Before(t_ns_), number);
    result_.recording.cam0->filenames.push_back({t_ns_, fmt::format("{}.png", t_ns_)});
    if (camera_->save) camera_->save(t_ns_, frame);
    return frame;
  }

  void NoteTip(const TipTrack& track) {
    result_.recording.vision0->tips.push_back({t_ns_, track.tip});
    if (!track.tip.d_RE) return;
    squared_direction_noise_ += track.direction_noise_rad * track.direction_noise_rad;
    ++directions_;
  }

  void Update() {
    ControllerInputs inputs;
    inputs.t_ns = inputs.pictures_t_ns = t_ns_;
    inputs.sensors = NewestReadings(result_.recording);
    sensor_faults_.Disturb(t_ns_, inputs.sensors);
    TakeOffLatencies(setup_, inputs);
    if (!supervision_.waits) p_RE_goal_ = path_->Advance(p_RE_known_);
    inputs.p_RE_desired = p_RE_goal_;
    inputs.d_RE_desired = path_->Direction();
    inputs.resume = Resumes();
    std::optional<Image> frame;
    if (camera_ != nullptr && t_ns_ >= next_picture_ns_) frame = TakePicture();
    const Image* const pictures[] = {frame ? &*frame : nullptr};
    if (frame) inputs.pictures = pictures;
    const ControllerCommand command = controller_.Step(inputs);
    if (frame) NoteTip(*controller_.Track());
    if (command.status != ControlStatus::kNoTip) p_RE_known_ = command.p_RE_used;
    Command(command);
    Note(command, inputs.resume);
    if (setup_.note_cycle) setup_.note_cycle(CycleOf(inputs, command));
  }

  /// The cycle without its picture: the tip that was seen in it stands for it.
  LoopCycle CycleOf(const ControllerInputs& inputs, const ControllerCommand& command) const {
    LoopCycle cycle;
    cycle.t_ns = inputs.t_ns;
    cycle.sensors = inputs.sensors;
    if (!inputs.pictures.empty()) {
      const TipTrack& track = *controller_.Track();
      cycle.sensors.tip = {inputs.pictures_t_ns, {track.tip, track.direction_noise_rad}};
    }
    cycle.p_RE_desired = inputs.p_RE_desired;
    cycle.d_RE_desired = inputs.d_RE_desired;
    cycle.resume = inputs.resume;
    TakeCommand(command, cycle);
    return cycle;
  }

  /// Whether a person says so in this cycle.
  bool Resumes() {
    if (!setup_.resume_s || supervision_.reaction != Reaction::kFault) return false;
    const double t_s = Seconds(t_ns_);
    if (t_s < std::max(*setup_.resume_s, resumed_s_ + 1.0)) return false;
    resumed_s_ = t_s;
    return true;
  }

  /// The arm is commanded in its encoders' figures. It refuses what is not finite.
  void Command(const ControllerCommand& command) {
    const bool unknown = command.status == ControlStatus::kNoWrist;
    if (unknown && command.supervision.reaction < Reaction::kHold) return;
    p_RW_sent_ = command.p_RW_command;
    if (robot_faults_.LosesCommand(Seconds(t_ns_))) return;
    if (command.p_RW_command.allFinite()) servo_.MoveTo(command.p_RW_command);
  }

  void Note(const ControllerCommand& command, bool resumed) {
    supervision_ = command.supervision;
    if (!result_.recording.command0) {
      result_.recording.command0.emplace();
      result_.recording.command0->comment = Name(setup_.controller.kind);
      result_.recording.command0->rate_hz = setup_.update_rate_hz;
    }
    result_.recording.command0->p_RW.push_back({t_ns_, command.p_RW_command});
    ++result_.control_statuses[Name(command.status)];
    if (result_.recording.vision0 && !result_.recording.vision0->tips.empty()) {
      ++result_.tip_statuses[Name(result_.recording.vision0->tips.back().value.status)];
    }
    if (!setup_.fixtures.list.empty()) ++result_.fixture_statuses[Name(command.goal.status)];
    result_.steps_limited += command.step_limited;
    result_.steps_damped += command.damped;
    LoopUpdate update;
    update.t_ns = t_ns_;
    update.p_RE_desired = command.goal.p_RE_desired;
    update.p_RE = shape_.T_RE().p;
    update.status = command.status;
    update.tip = command.measurements.tip;
    update.supervision = command.supervision;
    update.cause = command.cause;
    update.resumed = resumed;
    update.p_RW = servo_.p_RW();
    update.p_RW_command = p_RW_sent_;
    update.f_tip_N = shape_.f_tip_N;
    result_.updates.push_back(update);
  }

  /// Scoring, with the truth: how far the tip is from the path.
  void Score(bool at_update) {
    const double deviation = path_->Deviation(shape_.T_RE().p);
    if (at_update) result_.updates.back().deviation_m = deviation;
    result_.max_deviation_m = std::max(result_.max_deviation_m, deviation);
    squared_deviation_ += deviation * deviation;
    ++scored_;
  }

  void Finish() {
    result_.gain = controller_.Gain();
    result_.rms_deviation_m = std::sqrt(squared_deviation_ / scored_);
    result_.final_error_m = (shape_.T_RE().p - result_.updates.back().p_RE_desired).norm();
    if (const auto d_RE = path_->Direction()) {
      const Eigen::Vector3d is = shape_.T_RE().R.col(0);
      result_.final_direction_error_rad = std::atan2(is.cross(*d_RE).norm(), is.dot(*d_RE));
    }
    if (directions_ > 0) {
      result_.recording.vision0->direction_noise_rad =
          std::sqrt(squared_direction_noise_ / directions_);
    }
  }

  const LoopSetup& setup_;
  const LoopCamera* camera_;
  Plant plant_;
  Sensors sensors_;
  InstrumentController controller_;
  std::optional<TipPath> path_;
  PlantShape shape_;
  WristServo servo_;
  CurveHistory curves_;
  SensorFaults sensor_faults_;
  PlantFaults plant_faults_;
  RobotFaults robot_faults_;
  Supervision supervision_;  // of the last cycle
  double resumed_s_ = -1.0;
  bool has_set_in_ = false;
  Eigen::Vector3d p_RW_sent_ = Eigen::Vector3d::Zero();  // the last command
  Eigen::Vector3d p_RE_goal_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d wrist_shift_ = Eigen::Vector3d::Zero();  // of the true wrist from the encoders
  Eigen::Vector3d p_RE_known_ = Eigen::Vector3d::Zero();   // by the controller
  TimeNs t_ns_ = kSimulationStart_ns, next_picture_ns_ = kSimulationStart_ns;
  double squared_direction_noise_ = 0.0, squared_deviation_ = 0.0;
  int directions_ = 0, scored_ = 0;
  LoopResult result_;
};

}  // namespace

InstrumentControllerOptions ControllerOptionsOf(const LoopSetup& setup) {
  const Recording& base = setup.base;
  InstrumentControllerOptions options;
  options.estimator =
      EstimatorOptionsFor(base.instrument, base.p_RP, base.gravity_m_s2, setup.port_prior_m);
  options.control = setup.controller;
  options.direction = setup.direction;
  options.direction_free_axis = setup.direction_free_axis;
  options.fixtures = setup.fixtures;
  options.late.tip_time_sd_s = setup.tip_latency.sd_s;
  options.late.em0_time_sd_s = setup.em0_latency.sd_s;
  options.late.carry_em0 = setup.em0_latency.value_s != 0.0 || setup.em0_latency.sd_s != 0.0;
  options.rate_hz = setup.update_rate_hz;
  options.supervision = setup.supervision;
  return options;
}

std::unique_ptr<InstrumentTracker> TrackerOf(const LoopSetup& setup, const TrackerOptions* camera) {
  if (camera == nullptr) return nullptr;
  InstrumentTrackerSetup tracker = TrackerSetupOf(setup.base, *camera);
  tracker.with_model = true;
  return std::make_unique<InstrumentTracker>(tracker);
}

void TakeOffLatencies(const LoopSetup& setup, ControllerInputs& inputs) {
  const TimeNs tip_ns = std::llround(1e9 * setup.tip_latency.value_s);
  inputs.pictures_t_ns -= tip_ns;
  if (inputs.sensors.tip) inputs.sensors.tip->t_ns -= tip_ns;
  if (inputs.sensors.em0) inputs.sensors.em0->t_ns -= std::llround(1e9 * setup.em0_latency.value_s);
}

LoopResult RunClosedLoop(const LoopSetup& setup, const LoopCamera* camera,
                         const std::function<void(int, int)>& progress) {
  return Loop(setup, camera).Run(progress);
}

std::vector<Warning> WarningsOf(const LoopResult& result) {
  std::vector<Warning> warnings;
  FoundCause last;
  for (const LoopUpdate& update : result.updates) {
    if (IsNews(update.cause, last)) warnings.push_back({update.t_ns, update.cause});
    last = update.cause;
  }
  return warnings;
}

}  // namespace flextip::simulation
