#include "pipeline/instrument_controller.h"

#include <cmath>

#include "control/delay_gain.h"
#include "core/check.h"
#include "core/error.h"
#include "pipeline/tip_fusion.h"

namespace flextip {
namespace {

constexpr double kMotionDeviations = 2.0;    // of the ellipsoid in which the worst angle is sought
constexpr TimeNs kAhead_ns = 1'000'000'000;  // a stamp so far ahead is of another clock

bool IsStraight(ControllerKind kind) {
  return kind == ControllerKind::kStraightCalculate || kind == ControllerKind::kStraightTrack;
}
bool UsesBeam(ControllerKind kind) {
  return kind == ControllerKind::kFlexCalculate || kind == ControllerKind::kFlexTrack;
}
bool IsRod(ControllerKind kind) {
  return kind == ControllerKind::kRodCalculate || kind == ControllerKind::kRodTrack;
}

/// The instrument before anything was estimated: unloaded, through the port as registered.
ShaftModel UnloadedShaft(const EstimatorOptions& options) {
  ShaftModel model;
  model.instrument = options.instrument;
  model.p_RP = options.p_RP;
  model.weight_N_m = options.instrument.mass_per_length_kg_m * options.gravity_m_s2;
  return model;
}

/// Returns the gain that the doubt in the tip's latency leaves, where a step makes `part` of its
/// correction: the loop's is their product.
double GainOf(double gain, double part, const InstrumentControllerOptions& options) {
  if (!UsesTipMeasurement(options.control.kind)) return gain;
  const LateSampleOptions& late = options.late;
  const double sd_s = options.em_is_tip ? late.em0_time_sd_s : late.tip_time_sd_s;
  return GainUnderDelay(part * gain, {options.rate_hz, sd_s}) / part;
}

double PlaceGain(const InstrumentControllerOptions& options) {
  ControllerOptions place = options.control;
  place.rate_hz = options.rate_hz;
  return GainOf(place.gain, CorrectionPart(place), options);
}

ControllerOptions PlaceOptions(const InstrumentControllerOptions& options) {
  ControllerOptions place = options.control;
  place.rate_hz = options.rate_hz;
  place.gain = PlaceGain(options);
  return place;
}

EstimatorOptions OptionsFor(EstimatorOptions options, ControllerKind kind) {
  options.use_positions = UsesTipMeasurement(kind);
  options.fit_beam = UsesBeam(kind);
  return options;
}

/// Tissue is not learnt from a tip that is carried on by that tissue.
EstimatorOptions BetweenTips(const InstrumentControllerOptions& options) {
  EstimatorOptions between = OptionsFor(options.estimator, options.control.kind);
  between.estimate_tissue = false;
  return between;
}

}  // namespace

InstrumentController::InstrumentController(const InstrumentControllerOptions& options,
                                           std::unique_ptr<InstrumentModel> model,
                                           std::unique_ptr<InstrumentTracker> tracker,
                                           std::unique_ptr<InstrumentWatch> watch)
    : options_(options),
      model_(std::move(model)),
      tracker_(std::move(tracker)),
      watch_(std::move(watch)),
      estimator_(OptionsFor(options.estimator, options.control.kind), options.window_samples),
      place_(PlaceOptions(options)),
      guard_(options.estimator, options.supervision),
      motion_guard_(kMotionDeviations, options.control.max_tissue_gain,
                    options.supervision.rate_hz),
      supervisor_(options.supervision),
      path_watch_(options.supervision.max_tip_deviation_m, options.supervision.tolerances.tip_m),
      about_command_(options.supervision.rate_hz),
      between_(BetweenTips(options)),
      without_tip_(BetweenTips(options)),
      late_(options.late, options.control.max_tissue_gain),
      shaft_(UnloadedShaft(options.estimator)) {
  if (!options.direction) return;
  if (!IsRod(options.control.kind)) {
    throw InputError(std::string("the tip's direction needs a rod controller, not ") +
                     Name(options.control.kind));
  }
  DirectionOptions direction = *options.direction;
  direction.gain = GainOf(direction.gain, 1.0, options);
  direction_.emplace(direction);
}

void InstrumentController::SetTimeDeviations(double tip_sd_s, double em0_sd_s) {
  options_.late.tip_time_sd_s = tip_sd_s;
  options_.late.em0_time_sd_s = em0_sd_s;
  late_.SetTimeDeviations(tip_sd_s, em0_sd_s);
  place_.SetGain(PlaceGain(options_));
  if (direction_) direction_->SetGain(GainOf(options_.direction->gain, 1.0, options_));
}

void InstrumentController::VisitState(StateText& state) {
  FLEXTIP_CHECK(!tracker_, "a controller that is given tips");
  state(options_.late.tip_time_sd_s);
  state(options_.late.em0_time_sd_s);
  if (state.Reading()) SetTimeDeviations(options_.late.tip_time_sd_s, options_.late.em0_time_sd_s);
  if (model_) state(*model_);
  state(estimator_);
  state(place_);
  if (direction_) state(*direction_);
  state(tip_t_ns_);
  state(tip_is_hidden_);
  state(path_watch_);
  state(by_all_);
  state(p_RW_watched_);
  state(p_goal_last_);
  state(sent_);
  state(about_command_);
  state(corrections_);
  state(excess_m_);
  state(guard_);
  state(motion_guard_);
  state(supervisor_);
  state(by_others_);
  state(p_RE_last_);
  state(p_RW_last_);
  state(p_RE_offset_);
  state(between_);
  state(without_tip_);
  state(late_);
  state(carries_);
  state(tip_is_carried_);
  state(shaft_);
  state(f_tip_N_);
}

ControllerCommand InstrumentController::Step(const ControllerInputs& inputs) {
  ControllerCommand command;
  command.t_ns = inputs.t_ns;
  const SensorReadings seen = See(inputs, command.supervision);
  const std::optional<Measurements> gathered = Gather(Carry(seen, command.supervision));
  by_all_.reset();
  if (gathered) {
    command.measurements = Correct(inputs.t_ns, *gathered);
    by_all_ = Vote(inputs.t_ns, command.measurements, command.supervision);
    command.estimate = Estimate(inputs.t_ns, command.measurements);
    Fuse(command);
    command.goal = Keep(inputs, command.estimate);
    Control(inputs, command);
  }
  Watch(inputs, command);
  guard_.Believe(late_, seen, command.supervision);
  Supervise(inputs, command);
  KeepSent(command);
  return command;
}

/// Keeps what the next command goes on from. Where nothing is wanted of the tip, somebody else may
/// lead the wrist.
void InstrumentController::KeepSent(const ControllerCommand& command) {
  const bool led = command.status == ControlStatus::kNoGoal;
  if (led || command.status == ControlStatus::kNoWrist || !command.p_RW_command.allFinite()) {
    sent_.reset();
  } else {
    sent_ = {command.p_RW_command, command.goal.p_RE_desired};
  }
}

/// Track. The pictures are seen with the sensors as they are: an effect of the camera is corrected
/// in the tip, as in a recording. A late picture is seen with the wrist as it was then.
SensorReadings InstrumentController::See(const ControllerInputs& inputs, Supervision& found) {
  SensorReadings seen = inputs.sensors;
  guard_.ScreenSensors(inputs.t_ns, supervisor_.LastCommand(), seen, found);
  late_.Note(seen);
  if (tracker_ && !inputs.pictures.empty()) {
    track_ = tracker_->Follow(inputs.pictures, inputs.pictures_t_ns,
                              late_.PastAt(inputs.pictures_t_ns, seen).value_or(seen));
    seen.tip = {inputs.pictures_t_ns, {track_->tip, track_->direction_noise_rad}};
  }
  const bool is_new = seen.tip && (!tip_t_ns_ || seen.tip->t_ns > *tip_t_ns_);
  if (is_new) {
    // A stamp of another clock would make all tips that follow old ones.
    if (seen.tip->t_ns <= inputs.t_ns + kAhead_ns) tip_t_ns_ = seen.tip->t_ns;
    tip_is_hidden_ = seen.tip->value.tip.status == TipStatus::kLost;
  }
  if (!is_new) seen.tip.reset();
  guard_.ScreenTip(inputs.t_ns, late_, seen, found);
  return seen;
}

/// Carries late samples on to the wrist's time, and the last tip between two tips.
SensorReadings InstrumentController::Carry(SensorReadings seen, Supervision& found) {
  tip_is_carried_ = false;
  if (!seen.wrist) return seen;
  if (late_.HasLateTip(seen)) {
    carries_ = true;
    if (!EstimateThen(seen, found)) seen.tip.reset();
  }
  if (carries_) SeeBySensors(seen);
  tip_is_carried_ = late_.Carry(shaft_, seen);
  carries_ |= tip_is_carried_;
  return seen;
}

/// Learns load and tissue from what all sensors said when the late tip was seen, where that is
/// known. Returns whether the tip may be used.
bool InstrumentController::EstimateThen(const SensorReadings& seen, Supervision& found) {
  const auto past = late_.PastAt(seen.tip->t_ns, seen);
  if (!past) return true;
  Measurements then = *Gather(*past);
  if (model_) then = model_->Correct(then);
  const bool had_tip = then.tip.has_value();
  Vote(seen.tip->t_ns, then, found);
  const ShaftEstimate estimate = estimator_.Update(then, model_ ? model_->Shaft() : ShaftChange());
  Learn(seen.tip->t_ns, estimate);
  LookFor(seen.tip->t_ns, *past, then);
  return then.tip.has_value() || !had_tip;
}

void InstrumentController::SeeBySensors(const SensorReadings& seen) {
  SensorReadings others = seen;
  others.tip.reset();
  if (!others.em0 && !others.strain && !others.load) return;
  const auto z = Gather(others);
  const ShaftEstimate estimate = without_tip_.Update(model_ ? model_->Correct(*z) : *z,
                                                     model_ ? model_->Shaft() : ShaftChange());
  if (estimate.status == EstimateStatus::kOk)
    late_.NoteTipBySensors(seen.wrist->t_ns, estimate.p_RE, estimate.p_RE_covariance_m2);
}

void InstrumentController::Learn(TimeNs t_ns, const ShaftEstimate& estimate) {
  if (estimate.status != EstimateStatus::kOk && estimate.status != EstimateStatus::kUnobservable)
    return;
  shaft_ = estimate.model;
  late_.Learn(t_ns, shaft_);
}

/// Undoes what the found model says of the sensors.
Measurements InstrumentController::Correct(TimeNs t_ns, const Measurements& measured) {
  if (!model_) return measured;
  model_->Advance(t_ns, measured, f_tip_N_);
  return model_->Correct(measured);
}

ShaftEstimate InstrumentController::Estimate(TimeNs t_ns, const Measurements& measurements) {
  InstrumentEstimator& estimator = tip_is_carried_ ? between_ : estimator_;
  ShaftEstimate estimate = estimator.Update(measurements, model_ ? model_->Shaft() : ShaftChange());
  if (model_) AddLengthDoubt(*model_, estimate);
  f_tip_N_ = estimate.model.f_tip_N;
  if (tip_is_carried_) {
    estimate.model.tissue_stiffness_N_m = shaft_.tissue_stiffness_N_m;
  } else {
    Learn(t_ns, estimate);
  }
  if (IsStraight(options_.control.kind) && options_.straight_at_registered_port)
    estimate.model.p_RP = options_.estimator.p_RP;
  return estimate;
}

void InstrumentController::LookFor(TimeNs t_ns, const SensorReadings& readings,
                                   const Measurements& z) {
  if (!watch_) return;
  const auto time = [](const auto& sample) { return sample ? sample->t_ns : TimeNs(0); };
  const ShaftChange none;
  watch_->Look(
      {t_ns,
       z,
       {time(readings.em0), time(readings.em1), time(readings.strain), time(readings.load)},
       model_ ? model_->Shaft() : none});
}

/// Looks for causes of misfit. Late tips were looked at for the time at which they were seen, and
/// one that is carried on says nothing new.
void InstrumentController::Watch(const ControllerInputs& inputs, ControllerCommand& command) {
  if (!watch_) return;
  if (!tip_is_carried_ && command.status != ControlStatus::kNoWrist)
    LookFor(inputs.t_ns, inputs.sensors, command.measurements);
  watch_->Work();
  command.cause = watch_->Found();
}

/// Keeps the goal out of forbidden regions.
FixturesOutput InstrumentController::Keep(const ControllerInputs& inputs,
                                          const ShaftEstimate& estimate) const {
  if (!inputs.p_RE_desired) return {};
  const bool known = estimate.status == EstimateStatus::kOk;
  const double tip_sd_m = known ? MaxSd(estimate.p_RE_covariance_m2) : 0.0;
  return Constrain(options_.fixtures, *inputs.p_RE_desired, tip_sd_m);
}

void InstrumentController::Control(const ControllerInputs& inputs, ControllerCommand& command) {
  command.p_RW_command = command.measurements.p_RW;
  if (!inputs.p_RE_desired) {
    command.status = ControlStatus::kNoGoal;
  } else if (direction_ && inputs.d_RE_desired) {
    ControlDirection(*inputs.d_RE_desired, command);
  } else {
    ControlPlace(command);
  }
}

void InstrumentController::ControlPlace(ControllerCommand& command) {
  ControlInput input;
  input.p_RW = command.measurements.p_RW;
  input.p_RE_desired = command.goal.p_RE_desired;
  input.p_RE_measured = command.p_RE_measured.value_or(Eigen::Vector3d::Zero());
  input.tip_measured = command.p_RE_measured.has_value();
  input.model = command.estimate.model;
  input.last = sent_;
  const ControlOutput output = place_.Step(input);
  command.status = output.status;
  command.p_RW_command = output.p_RW_command;
  command.p_RE_used = output.p_RE_used;
  command.step_limited = output.step_limited;
  command.damped = output.damped;
  command.J_tip_wrist = output.J_tip_wrist;
}

/// Place and direction: the tip as tracked, or by the rod where the kind calculates it.
void InstrumentController::ControlDirection(const Eigen::Vector3d& d_RE_desired,
                                            ControllerCommand& command) {
  const ShaftEstimate& estimate = command.estimate;
  const bool tracks = UsesTipMeasurement(options_.control.kind);
  command.status = ControlStatus::kNoTip;
  if (tracks && !command.p_RE_measured) return;
  command.status = ControlStatus::kNoModel;
  const bool fits =
      estimate.status == EstimateStatus::kOk || estimate.status == EstimateStatus::kUnobservable;
  if (!fits) return;
  DirectionInput input;
  input.p_RW = command.measurements.p_RW;
  input.p_RE = tracks ? *command.p_RE_measured : estimate.p_RE;
  input.d_RE = estimate.d_RE;
  input.p_RE_desired = command.goal.p_RE_desired;
  input.d_RE_desired = d_RE_desired;
  input.free_axis = options_.direction_free_axis;
  input.model = estimate.model;
  const DirectionOutput output = direction_->Step(input);
  command.status = output.status;
  command.p_RW_command = output.p_RW_command;
  command.p_RE_used = input.p_RE;
  command.step_limited = output.step_limited;
  command.damped = output.damped;
}

}  // namespace flextip
