// The stages of a control cycle in which the supervisor acts.
#include <algorithm>
#include <cmath>

#include "control/supervision/least_norm.h"
#include "pipeline/instrument_controller.h"
#include "pipeline/tip_fusion.h"

namespace flextip {
namespace {

// The other sensors carry the tip while it is, by three of its deviations, within half of the 2 mm
// that count as astray.
constexpr double kTakeOver_m = 0.0003;
constexpr double kKnown_m = 0.001;  // half of these 2 mm
constexpr double kDiffers_m = 2.0 * kTakeOver_m;
constexpr double kTakeOver_s = 0.3;  // in which a difference of sources is taken up

// Two pictures that are wrong in a row may lead the tip by 1.2 of what it may be astray: the first
// by this part, the second by twice that. By then the vote has them.
constexpr double kCorrection = 0.4;
// About the last command, it may take half of the last correction back and make its own.
constexpr double kCorrections = 1.5;
// Along the goal's way a tip that lags may catch up by half of a correction.
constexpr double kCatchUp = 0.5;

constexpr double kForceDeviations = 3.0;
constexpr double kLeastShaft = 0.01;  // of its length, on either side of the port
constexpr double kStepDeviations = 3.0;
constexpr double kLeastStep_m = 0.0005;  // whatever the noise: a quarter of what counts as astray

/// Whether the tip force is above `limit_N` (0: none), wherever it is within its deviations. Along
/// the shaft it is often not known.
bool PressesTooHard(const std::optional<VotedShaft>& shaft, double limit_N) {
  return limit_N > 0.0 && shaft &&
         LeastNorm(shaft->f_tip_N, shaft->force_covariance_N2, kForceDeviations) > limit_N;
}

/// Whether there is too little shaft before or beyond the port for a lever. The controller keeps a
/// wrist within twice that of the port as it knows it.
bool LacksShaft(const ShaftEstimate& estimate) {
  if (estimate.status != EstimateStatus::kOk && estimate.status != EstimateStatus::kUnobservable)
    return false;
  const double part = estimate.s_port_m / estimate.model.instrument.length_m;
  return part < kLeastShaft || part > 1.0 - kLeastShaft;
}

}  // namespace

/// Takes out the sensor that disagrees with the others.
std::optional<VotedShaft> InstrumentController::Vote(TimeNs t_ns, Measurements& z,
                                                     Supervision& found) {
  return guard_.Vote(t_ns, model_ ? model_->Shaft() : ShaftChange(), z, found);
}

/// The tip for the controller. Where its own sensor is out or gone, rod-track goes on with what the
/// others say, while they know it well enough; and back, without a jump.
void InstrumentController::Fuse(ControllerCommand& command) {
  const ShaftEstimate& estimate = command.estimate;
  command.p_RE_measured =
      FuseTip(options_.control.kind, command.measurements, estimate, options_.em_is_tip);
  if (options_.supervision.kind != SupervisionKind::kFull ||
      options_.control.kind != ControllerKind::kRodTrack)
    return;
  const double tip_sd_m = MaxSd(estimate.p_RE_covariance_m2);
  // Where nobody else knows the load the fit leads a tip that is missing to where no load is.
  const bool missing = tip_is_carried_ && guard_.TipIsDue(late_.TipCame_ns(), command.t_ns);
  if (missing && tip_sd_m > kKnown_m)
    command.p_RE_measured = MeasuredTip(command.measurements, options_.em_is_tip);
  const bool others =
      !command.p_RE_measured && estimate.status == EstimateStatus::kOk && tip_sd_m < kTakeOver_m;
  if (others) command.p_RE_measured = estimate.p_RE;
  if (!command.p_RE_measured) {
    p_RE_last_.reset();
    return;
  }
  const Eigen::Vector3d& p_RW = command.measurements.p_RW;
  if (others != by_others_ && p_RE_last_) {
    // What the wrist did since is no difference of the sources, nor what neither of them knows.
    const Eigen::Matrix3d J = motion_guard_.Jacobian().value_or(Eigen::Matrix3d::Zero());
    const Eigen::Vector3d differs = *p_RE_last_ + J * (p_RW - p_RW_last_) - *command.p_RE_measured;
    p_RE_offset_ = std::min(1.0, kDiffers_m / differs.norm()) * differs;
  }
  by_others_ = others;
  p_RE_offset_ *= std::exp(-1.0 / (options_.supervision.rate_hz * kTakeOver_s));
  *command.p_RE_measured += p_RE_offset_;
  p_RE_last_ = command.p_RE_measured;
  p_RW_last_ = p_RW;
}

/// A wrist that is held has no jump to fear from a change of sources. What held it may have led one
/// of them far off.
void InstrumentController::ForgetSources() {
  p_RE_last_.reset();
  p_RE_offset_.setZero();
}

/// Whether the tip may move by more than the limit beside what this step wants. A step that is
/// within the tip's noise wants nothing.
bool InstrumentController::MayPointWrong(ControllerCommand& command) {
  const Eigen::Vector3d& p_RW = command.measurements.p_RW;
  motion_guard_.Update(command.estimate, p_RW);
  const Eigen::Vector3d wanted = command.goal.p_RE_desired - command.p_RE_used;
  const double sd_m =
      MaxSd(by_all_ ? by_all_->tip.covariance_m2 : command.estimate.p_RE_covariance_m2);
  if (wanted.norm() < std::min(kStepDeviations * sd_m, kLeastStep_m)) return false;
  double& angle_rad = command.supervision.worst_angle_rad;
  angle_rad = motion_guard_.StepAngle(wanted, command.p_RW_command - p_RW);
  return angle_rad > options_.supervision.max_motion_angle_rad;
}

/// Whether a controller that calculates its tip has lost a sensor, and does not know the tip well
/// without it.
bool InstrumentController::LosesItsLoad(const ControllerCommand& command) const {
  if (UsesTipMeasurement(options_.control.kind) || command.supervision.voted_out == 0) return false;
  const ShaftEstimate& estimate = command.estimate;
  return estimate.status != EstimateStatus::kOk || MaxSd(estimate.p_RE_covariance_m2) > kTakeOver_m;
}

/// How the wrist moved the tip since the last call, by the exact rod.
Eigen::Vector3d InstrumentController::WayOfTip(const Eigen::Vector3d& p_RW) {
  const Eigen::Vector3d way = p_RW - p_RW_watched_.value_or(p_RW);
  p_RW_watched_ = p_RW;
  return motion_guard_.Jacobian().value_or(Eigen::Matrix3d::Zero()) * way;
}

/// The wish, with so little of a correction that one wrong sample does not lead the tip astray. A
/// correction that goes on in one direction is no single sample's: it may grow. About the last
/// command it may not: there the reading itself may be what is wrong.
Limited InstrumentController::Corrected(const ControllerCommand& command) {
  const Eigen::Vector3d& p_goal = command.goal.p_RE_desired;
  const Eigen::Vector3d way = p_goal - p_goal_last_.value_or(p_goal);
  p_goal_last_ = p_goal;
  const auto J = motion_guard_.Jacobian();
  const SupervisorOptions& options = options_.supervision;
  if (!J || options.max_tip_deviation_m <= 0.0) return {command.p_RW_command, false};
  const double once_m = kCorrection * options.max_tip_deviation_m;
  const double pictures = std::min(1.0, kVideo_hz / options.rate_hz);  // a cycle
  const double most_m = once_m * (1.0 + pictures * corrections_);
  // Each reading has its own noise: what it led to before does not count.
  Limited limited = CorrectionLimit().Limit(command.measurements.p_RW, command.p_RW_command, *J,
                                            way, {most_m, kCatchUp * most_m});
  if (const auto& p_last = supervisor_.LastCommand()) {
    const double next_m = kCorrections * once_m;
    const Limited next =
        about_command_.Limit(*p_last, limited.p, *J, way, {next_m, kCatchUp * next_m});
    limited = {next.p, limited.limited || next.limited};
  }
  const Eigen::Vector3d excess_m = command.p_RW_command - limited.p;
  const bool goes_on = limited.limited && excess_m.dot(excess_m_) > 0.0;
  corrections_ = goes_on ? corrections_ + 1 : 0;
  excess_m_ = excess_m;
  return limited;
}

/// The wish, with so little of it across the way that the tip keeps to it: a controller may know
/// the shaft worse than the rod of all sensors does.
Limited InstrumentController::KeptToWay(const ControllerCommand& command, const Limited& wish) {
  const auto J = motion_guard_.Jacobian();
  const auto& p_last = supervisor_.LastCommand();
  if (options_.supervision.max_tip_deviation_m <= 0.0 || !by_all_ || !J || !p_last) return wish;
  const Eigen::Vector3d step = wish.p - *p_last, step_RE = *J * step;
  const Eigen::Vector3d before = *J * (*p_last - command.measurements.p_RW);
  const Eigen::Vector3d kept = path_watch_.Kept(before, step_RE);
  if (kept == step_RE) return wish;
  // A wrist that would have to go farther for that goes a part of it.
  const Eigen::Vector3d less = J->fullPivLu().solve(kept);
  if (!less.allFinite()) return {*p_last, true};
  return {*p_last + std::min(1.0, step.norm() / less.norm()) * less, true};
}

/// The last word over the command.
void InstrumentController::Supervise(const ControllerInputs& inputs, ControllerCommand& command) {
  const SupervisorOptions& options = options_.supervision;
  if (options.kind == SupervisionKind::kNone) return;
  Supervision& found = command.supervision;
  const bool acts =
      command.status == ControlStatus::kOk || command.status == ControlStatus::kStraightInstead;
  const auto hold = [&found](bool cause, Stop stop) {
    if (!cause || found.reaction >= Reaction::kHold) return;
    found.stop = stop;
    found.reaction = Reaction::kHold;
  };
  SupervisedCycle cycle;
  cycle.t_ns = inputs.t_ns;
  cycle.resume = inputs.resume;
  if (command.status != ControlStatus::kNoWrist) {
    cycle.p_RW = command.measurements.p_RW;
    cycle.p_RW_noise_m = command.measurements.wrist_position_noise_m;
  }
  if (acts) cycle.p_wish = command.p_RW_command;
  if (options.kind == SupervisionKind::kFull) {
    hold(command.status == ControlStatus::kNoWrist, Stop::kStaleWrist);
    // Between two tips the wrist only waits.
    const bool no_tip = command.status == ControlStatus::kNoTip && inputs.p_RE_desired;
    const bool is_out = IsOut(found, VotedSensor::kTip) || IsOut(found, VotedSensor::kEm);
    hold(no_tip && guard_.TipIsStale(inputs.t_ns), Stop::kStaleTip);
    hold(no_tip && is_out, Stop::kTipDisagrees);
    hold(LosesItsLoad(command), Stop::kSourceLost);
    hold(PressesTooHard(by_all_, options.max_tip_force_N), Stop::kForce);
    hold(LacksShaft(command.estimate), Stop::kPortDepth);
    const bool hidden = tip_is_hidden_ || (no_tip && guard_.TipIsOverdue(inputs.t_ns));
    cycle.tip_is_hidden =
        hidden && !by_others_ && UsesTipMeasurement(options_.control.kind) && inputs.p_RE_desired;
    if (by_all_ && inputs.p_RE_desired) {
      hold(path_watch_.IsAstray(inputs.t_ns, by_all_->tip, WayOfTip(command.measurements.p_RW),
                                command.goal.p_RE_desired),
           Stop::kTipAstray);
      if (path_watch_.MayBeAstray()) found.doubt = Stop::kTipAstray;
      hold(path_watch_.MovesOtherwise(inputs.t_ns), Stop::kModelDisagrees);
    }
    // A wrist that is held goes nowhere, and what holds it may leave no rod to judge by.
    const bool moves = acts && !command.J_tip_wrist.isZero(0.0) && found.reaction < Reaction::kHold;
    if (moves) {
      cycle.may_point_wrong = MayPointWrong(command);
      const Limited corrected = KeptToWay(command, Corrected(command));
      cycle.p_wish = corrected.p;
      if (corrected.limited && found.reaction == Reaction::kNone) {
        found.stop = Stop::kStep;
        found.reaction = Reaction::kLimit;
      }
    }
  }
  cycle.found = found;
  const Supervisor::Decision decision = supervisor_.Decide(cycle);
  if (decision.resumed) guard_.Forget();
  found = decision.supervision;
  const bool held = found.reaction >= Reaction::kHold;
  const bool by_path = held && found.stop == Stop::kTipAstray;
  if (held) ForgetSources();
  if ((held && !by_path) || decision.resumed) path_watch_.ComeBack(inputs.t_ns);
  if (by_path) path_watch_.TryOnce(inputs.t_ns);
  if (decision.p_RW_command) command.p_RW_command = *decision.p_RW_command;
}

}  // namespace flextip
