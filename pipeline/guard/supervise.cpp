// The stages of a control cycle in which the supervisor acts.
#include <cmath>

#include "control/supervision/least_norm.h"
#include "pipeline/instrument_controller.h"
#include "pipeline/tip_fusion.h"

namespace flextip {
namespace {

// The other sensors carry the tip while its deviation is a quarter of the 2 mm that count as
// astray.
constexpr double kTakeOver_m = 0.0005;
constexpr double kTakeOver_s = 0.3;  // in which a difference of sources is taken up

constexpr double kForceDeviations = 3.0;

/// Whether the tip force is above `limit_N` (0: none), wherever it is within its deviations. Along
/// the shaft it is often not known.
bool PressesTooHard(const ShaftEstimate& estimate, double limit_N) {
  if (limit_N <= 0.0 || estimate.status != EstimateStatus::kOk) return false;
  return LeastNorm(estimate.model.f_tip_N, estimate.covariance.bottomRightCorner<3, 3>(),
                   kForceDeviations) > limit_N;
}

}  // namespace

/// Takes out the sensor that disagrees with the others.
void InstrumentController::Vote(TimeNs t_ns, Measurements& z, Supervision& found) {
  guard_.Vote(t_ns, model_ ? model_->Shaft() : ShaftChange(), z, found);
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
  const bool others = !command.p_RE_measured && estimate.status == EstimateStatus::kOk &&
                      MaxSd(estimate.p_RE_covariance_m2) < kTakeOver_m;
  if (others) command.p_RE_measured = estimate.p_RE;
  if (!command.p_RE_measured) {
    p_RE_last_.reset();
    return;
  }
  if (others != by_others_ && p_RE_last_) p_RE_offset_ = *p_RE_last_ - *command.p_RE_measured;
  by_others_ = others;
  p_RE_offset_ *= std::exp(-1.0 / (options_.supervision.rate_hz * kTakeOver_s));
  *command.p_RE_measured += p_RE_offset_;
  p_RE_last_ = command.p_RE_measured;
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
    hold(PressesTooHard(command.estimate, options.max_tip_force_N), Stop::kForce);
    if (acts && !command.J_tip_wrist.isZero(0.0)) {
      found.worst_angle_rad =
          motion_guard_.Update(command.J_tip_wrist, command.estimate, command.measurements.p_RW);
      cycle.may_point_wrong = found.worst_angle_rad > options.max_motion_angle_rad;
    }
  }
  cycle.found = found;
  const Supervisor::Decision decision = supervisor_.Decide(cycle);
  if (decision.resumed) guard_.Forget();
  found = decision.supervision;
  if (decision.p_RW_command) command.p_RW_command = *decision.p_RW_command;
}

}  // namespace flextip
