#include "live/loop/cycle.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "control/supervision/rate_limits.h"
#include "core/rotation.h"
#include "diagnosis/model/extended_instrument.h"
#include "diagnosis/running/running_diagnosis.h"

namespace flextip::live {
namespace {

constexpr double kAskAgain_s = 0.2;  // a robot that did not change its state

double Seconds(TimeNs span_ns) { return 1e-9 * static_cast<double>(span_ns); }

bool Acts(ControlStatus status) {
  return status == ControlStatus::kOk || status == ControlStatus::kStraightInstead;
}

}  // namespace

InstrumentControllerOptions OptionsOf(const Session& session) {
  InstrumentControllerOptions options;
  const Recording& base = session.base;
  options.estimator =
      EstimatorOptionsFor(base.instrument, base.p_RP, base.gravity_m_s2, session.port_prior_m);
  options.window_samples = session.window_samples;
  options.control = session.task.controller;
  options.direction = session.task.direction;
  options.direction_free_axis = session.task.direction_free_axis;
  options.fixtures = session.task.fixtures;
  options.em_is_tip = session.EmIsTip();
  const Latency em0 = session.LatencyOf(StreamName::kEm0);
  const bool em0_has_clock = session.base.em0 && !session.base.em0->clock.covariance.isZero(0.0);
  options.late.carry_em0 =
      session.EmIsTip() || em0.value_s != 0.0 || em0.sd_s != 0.0 || em0_has_clock;
  options.rate_hz = session.rate_hz;
  options.supervision = session.task.supervision;
  options.supervision.rate_hz = session.rate_hz;
  options.supervision.resume_after_s = session.limits.resume_after_s;
  // A session says when its streams are stale.
  double& stale_s = options.supervision.stale_s;
  if (session.camera) stale_s = std::max(stale_s, session.camera->stale_s);
  for (const auto& stream : session.streams)
    if (stream) stale_s = std::max(stale_s, stream->stale_s);
  return options;
}

std::unique_ptr<InstrumentModel> ModelOf(const Session& session) {
  if (!session.model) return nullptr;
  return std::make_unique<diagnosis::ExtendedInstrument>(*session.model, session.base);
}

std::unique_ptr<InstrumentWatch> WatchOf(const Session& session) {
  const WatchTask& watch = session.task.watch;
  if (!watch.running) return nullptr;
  return std::make_unique<diagnosis::RunningDiagnosis>(
      session.base, diagnosis::RunningOptions{watch.false_alarms_per_hour, session.port_prior_m});
}

Cycle::Cycle(const Session& session, bool wait)
    : session_(session),
      wait_(wait),
      controller_(OptionsOf(session), ModelOf(session), nullptr, WatchOf(session)),
      jerk_({.max_acceleration_m_s2 = session.limits.max_acceleration_m_s2,
             .max_jerk_m_s3 = session.limits.max_jerk_m_s3},
            session.rate_hz) {}

/// The doubt in a clock grows with the time since it was found. The gain is found anew where it has
/// grown by a tenth.
void Cycle::KnowTimes(TimeNs t_ns) {
  constexpr double kGrown = 1.1;
  const double tip_s = session_.TimeSdOf(StreamName::kTip, t_ns);
  const double em0_s = session_.TimeSdOf(StreamName::kEm0, t_ns);
  const auto same = [](double sd_s, double before_s) {
    return sd_s <= kGrown * before_s && before_s <= kGrown * sd_s;
  };
  if (same(tip_s, tip_time_sd_s_) && same(em0_s, em0_time_sd_s_)) return;
  tip_time_sd_s_ = tip_s;
  em0_time_sd_s_ = em0_s;
  controller_.SetTimeDeviations(tip_s, em0_s);
}

CycleOutputs Cycle::Step(const CycleInputs& inputs) {
  CycleOutputs outputs;
  outputs.t_ns = inputs.t_ns;
  const bool time_runs = inputs.t_ns > t_ns_;
  const double dt_s =
      t_ns_ > 0 && time_runs ? Seconds(inputs.t_ns - t_ns_) : 1.0 / session_.rate_hz;
  outputs.has_command = inputs.streams.wrist.has_value();
  if (outputs.has_command && inputs.streams.wrist->value.q_RW)
    outputs.R_RW = inputs.streams.wrist->value.q_RW->toRotationMatrix();
  outputs.hold = time_runs ? FindHold(session_, inputs, phase_ == Phase::kWaiting, outputs.held_by)
                           : Hold::kBadTime;
  if (outputs.hold != Hold::kNone) {
    clear_since_ns_ = 0;
  } else {
    if (clear_since_ns_ == 0) clear_since_ns_ = inputs.t_ns;
    if (Seconds(inputs.t_ns - clear_since_ns_) < session_.limits.resume_after_s)
      outputs.hold = Hold::kResuming;
  }
  const bool ends = inputs.stop || phase_ == Phase::kDone;
  if (ends) outputs.hold = Hold::kStopped;
  outputs.state_command = ends ? Ending(inputs) : StartUp(inputs);
  if (!time_runs) {
    HoldStill(inputs, outputs);
    return outputs;
  }
  t_ns_ = inputs.t_ns;
  KnowTimes(t_ns_);

  const auto tip_times = TimesIn(inputs.streams, StreamName::kTip);
  const bool new_tip = tip_times && tip_times->first > tip_t_ns_;
  const bool clear = outputs.hold == Hold::kNone;
  if (clear && !session_.path) outputs.hold = Hold::kNoGoal;
  if (clear && session_.path && phase_ == Phase::kWaiting) phase_ = Phase::kAveraging;
  if (!clear && phase_ == Phase::kAveraging) average_from_ns_ = 0;
  const bool moves = clear && phase_ == Phase::kMoving;
  ControllerInputs wish = Wish(inputs, moves, new_tip, dt_s, outputs);
  wish.resume = PersonResumed(inputs);
  if (new_tip) tip_t_ns_ = tip_times->first;
  command_ = controller_.Step(wish);
  const ControllerCommand& command = command_;
  outputs.status = command.status;
  outputs.supervision = command.supervision;
  outputs.cause = command.cause;
  if (wish.p_RE_desired && Acts(command.status)) p_RE_known_ = command.p_RE_used;
  if (clear && phase_ == Phase::kAveraging) {
    outputs.hold = Hold::kStarting;
    Average(inputs, command, new_tip);
  }
  if (moves) {
    outputs.p_RE_goal = command.goal.p_RE_desired;
    outputs.fixture_limited = command.goal.status != FixtureStatus::kFree;
    Command(command, dt_s, outputs);
    if (path_ && path_->Done() && outputs.hold == Hold::kNone) {
      outputs.done = true;
      phase_ = Phase::kDone;
    }
  }
  Fault(inputs, outputs);
  if (outputs.hold != Hold::kNone) HoldStill(inputs, outputs);
  if (outputs.has_command) controller_.NoteSent(outputs.p_RW_command);
  outputs.p_RE = p_RE_known_;
  return outputs;
}

/// A fault pauses the robot. Whoever enables it again says that it may go on.
bool Cycle::PersonResumed(const CycleInputs& inputs) {
  const auto& state = inputs.streams.state;
  if (!fault_ || !state) return false;
  const bool enabled = state->value.state == CrtkState::kEnabled;
  if (!enabled) paused_by_fault_ = true;
  return enabled && paused_by_fault_;
}

void Cycle::Fault(const CycleInputs& inputs, CycleOutputs& outputs) {
  fault_ = command_.supervision.reaction == Reaction::kFault;
  if (!fault_) paused_by_fault_ = false;
  if (fault_ && !outputs.state_command) outputs.state_command = Ending(inputs);
}

/// The robot is homed and enabled once. Whoever disables or pauses it later has a reason.
std::optional<CrtkCommand> Cycle::StartUp(const CycleInputs& inputs) {
  const auto& state = inputs.streams.state;
  if (!state || enabled_once_) return {};
  const CrtkOperatingState& robot = state->value;
  if (robot.state == CrtkState::kEnabled && robot.is_homed && !robot.is_busy) {
    enabled_once_ = true;
    return {};
  }
  if (wait_ || !session_.robot.command_state || robot.is_busy) return {};
  if (session_.DelayIsUnknown()) return {};
  if (robot.state == CrtkState::kFault) return {};
  if (Seconds(inputs.t_ns - asked_ns_) < kAskAgain_s) return {};
  asked_ns_ = inputs.t_ns;
  if (robot.state == CrtkState::kPaused) return CrtkCommand::kResume;
  if (robot.state == CrtkState::kEnabled) return CrtkCommand::kHome;
  // Disabled: some robots are enabled by homing alone.
  asked_home_ = !asked_home_;
  return asked_home_ || robot.is_homed ? CrtkCommand::kEnable : CrtkCommand::kHome;
}

std::optional<CrtkCommand> Cycle::Ending(const CycleInputs& inputs) {
  const auto& state = inputs.streams.state;
  if (!session_.robot.command_state || !state || state->value.state != CrtkState::kEnabled)
    return {};
  if (Seconds(inputs.t_ns - asked_ns_) < kAskAgain_s) return {};
  asked_ns_ = inputs.t_ns;
  return CrtkCommand::kPause;
}

SensorReadings Cycle::Readings(const StreamInputs& streams) const {
  const Recording& base = session_.base;
  SensorReadings readings;
  if (streams.wrist && base.wrist0) {
    readings.wrist = {streams.wrist->t_ns, Measured(*base.wrist0, streams.wrist->value)};
    double& noise_m = readings.wrist->value.position_noise_m;
    const double time_sd_s = session_.TimeSdOf(StreamName::kWrist, t_ns_);
    noise_m = std::hypot(noise_m, time_sd_s * v_last_m_s_.norm());
  }
  if (streams.tip && base.vision0) {
    const SeenTip& seen = streams.tip->value;
    readings.tip = {streams.tip->t_ns, Measured(*base.vision0, seen.tip)};
    TipMeasurement& tip = readings.tip->value;
    tip.direction_noise_rad =
        std::hypot(seen.direction_noise_rad, base.vision0->registration_noise_rad);
  }
  if (streams.em0 && base.em0)
    readings.em0 = {streams.em0->t_ns, Measured(*base.em0, streams.em0->value)};
  if (streams.em1 && base.em1)
    readings.em1 = {streams.em1->t_ns, Measured(*base.em1, streams.em1->value)};
  if (streams.strain && base.strain0)
    readings.strain = {streams.strain->t_ns, Measured(*base.strain0, streams.strain->value)};
  if (streams.load && base.load0)
    readings.load = {streams.load->t_ns, Measured(*base.load0, streams.load->value)};
  return readings;
}

/// The controller's inputs. While the start is averaged, the goal is the tip itself: the controller
/// then says where it takes the tip to be, and its command is not used.
ControllerInputs Cycle::Wish(const CycleInputs& inputs, bool moves, bool new_tip, double dt_s,
                             CycleOutputs& outputs) {
  ControllerInputs wish;
  wish.t_ns = inputs.t_ns;
  wish.sensors = Readings(inputs.streams);
  if (phase_ == Phase::kAveraging && wish.sensors.wrist) {
    wish.p_RE_desired = averaged_ > 0 ? p_RE_known_ : wish.sensors.wrist->value.p_RW;
  }
  if (!moves) return wish;
  const bool waits_for_tip = session_.task.path.mode == PathMode::kSteps && session_.HasTip() &&
                             UsesTipMeasurement(session_.task.controller.kind) && !new_tip;
  if (session_.goal) {
    GoToGoal(inputs, dt_s);
  } else if (!p_goal_ || !(waits_for_tip || wrist_waits_)) {
    p_goal_ = path_->Advance(p_RE_known_);
  }
  Limited goal{*p_goal_, false};
  if (session_.limits.workspace) goal = KeepInBox(*session_.limits.workspace, *p_goal_);
  outputs.workspace_limited = goal.limited;
  wish.p_RE_desired = goal.p;
  if (path_) wish.d_RE_desired = path_->Direction();
  return wish;
}

/// The wish goes to the peer's newest goal at the session's speed; before the first it stays.
void Cycle::GoToGoal(const CycleInputs& inputs, double dt_s) {
  if (!p_goal_) p_goal_ = p_RE_known_;
  if (!inputs.streams.goal) return;
  const Eigen::Vector3d& p_RE = inputs.streams.goal->value.p_RE;
  p_goal_ = LimitSpeed(*p_goal_, p_RE, dt_s, session_.task.path.speed_m_s).p;
}

void Cycle::Average(const CycleInputs& inputs, const ControllerCommand& command, bool new_tip) {
  if (average_from_ns_ == 0) {
    average_from_ns_ = inputs.t_ns;
    averaged_ = 0;
    sum_p_.setZero();
    sum_d_.setZero();
  }
  const bool by_tip = session_.HasTip() && UsesTipMeasurement(session_.task.controller.kind);
  if (Acts(command.status) && (new_tip || !by_tip)) {
    sum_p_ += command.p_RE_used;
    sum_d_ += command.estimate.d_RE;
    ++averaged_;
  }
  const bool over = Seconds(inputs.t_ns - average_from_ns_) >= session_.path->average_s;
  if (over && averaged_ > 0) StartPath();
}

void Cycle::StartPath() {
  p_RE_known_ = sum_p_ / averaged_;
  phase_ = Phase::kMoving;
  if (!session_.goal) MakePath();
}

/// Makes the path from the averaged tip.
void Cycle::MakePath() {
  Pose T_RE;
  T_RE.p = sum_p_ / averaged_;
  T_RE.R = RotationWithoutTwist(Eigen::Vector3d::UnitX(), sum_d_.normalized());
  if (session_.path->p_start) T_RE.p = *session_.path->p_start;
  path_.emplace(session_.task.path, T_RE, session_.rate_hz);
}

void Cycle::Command(const ControllerCommand& command, double dt_s, CycleOutputs& outputs) {
  wrist_waits_ = command.supervision.waits;
  const Eigen::Vector3d& p_RW = command.measurements.p_RW;
  if (command.supervision.reaction >= Reaction::kHold) {
    outputs.hold = HoldBy(command.supervision.stop);
    if (moving_ && command.p_RW_command.allFinite()) p_held_ = command.p_RW_command;
    return;
  }
  if (Acts(command.status)) {
    p_target_ = command.p_RW_command;
  } else if (command.status != ControlStatus::kNoTip || !p_target_) {
    // Between two tips the last target stays.
    outputs.hold = Hold::kNoCommand;
    return;
  }
  if (!p_target_->allFinite()) {
    outputs.hold = Hold::kNotFinite;
    return;
  }
  const LimitSetup& limits = session_.limits;
  const Eigen::Vector3d p_from = moving_ || p_held_ ? p_last_ : p_RW;
  const Limited step = LimitStep(p_RW, *p_target_, limits.max_step_m);
  const Limited speed = LimitSpeed(p_from, step.p, dt_s, limits.max_speed_m_s);
  const Limited kept =
      LimitAcceleration(p_from, v_last_m_s_, speed.p, dt_s, limits.max_acceleration_m_s2);
  outputs.step_limited = step.limited;
  outputs.speed_limited = speed.limited;
  outputs.acceleration_limited = kept.limited;
  if (!moving_) jerk_.Reset(p_from);
  outputs.p_RW_command = jerk_.Next(kept.p);
  v_last_m_s_ = (kept.p - p_from) / dt_s;
  p_last_ = kept.p;
  moving_ = true;
  p_held_.reset();
}

/// The wrist as measured when the hold began: its noise would let it wander. A robot that does not
/// move is followed, so that it does not jump when it is enabled.
void Cycle::HoldStill(const CycleInputs& inputs, CycleOutputs& outputs) {
  moving_ = false;
  v_last_m_s_.setZero();
  p_target_.reset();
  if (!inputs.streams.wrist) return;
  const Eigen::Vector3d& p_RW = inputs.streams.wrist->value.p_RW;
  const auto& state = inputs.streams.state;
  const bool enabled =
      !session_.robot.state || (state && state->value.state == CrtkState::kEnabled);
  const bool far = p_held_ && (*p_held_ - p_RW).norm() > session_.limits.max_step_m;
  if (!enabled || !p_held_ || far) p_held_ = p_RW;
  p_last_ = *p_held_;
  outputs.p_RW_command = p_last_;
}

}  // namespace flextip::live
