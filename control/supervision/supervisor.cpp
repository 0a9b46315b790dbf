#include "control/supervision/supervisor.h"

#include <algorithm>
#include <cmath>

#include "control/supervision/rate_limits.h"

namespace flextip {
namespace {

double Seconds(TimeNs span_ns) { return 1e-9 * static_cast<double>(span_ns); }

constexpr double kLate = 1.5;         // of a cycle's time
constexpr double kSmoothed_m = 1e-5;  // by less the limit of jerk does not count as acting
constexpr double kDoubtful = 0.7;     // of what a reading may be beside the commanded way

WristReading WristOf(const SupervisedCycle& cycle) {
  return {cycle.t_ns, cycle.p_RW, cycle.p_RW_noise_m};
}

}  // namespace

void Supervisor::Keep(const SupervisedCycle& cycle, const Eigen::Vector3d& p_RW) {
  way_.Keep(WristOf(cycle), p_RW);
  p_last_ = p_RW;
}

void Supervisor::NoteSent(const Eigen::Vector3d& p_RW) {
  if (way_.IsEmpty() || !p_RW.allFinite()) return;
  way_.Replace(p_RW);
  p_last_ = p_RW;
  if (p_held_) p_held_ = p_RW;
}

void Supervisor::VisitState(StateText& state) {
  state(way_);
  state(p_last_);
  state(p_held_);
  state(v_last_m_s_);
  state(t_last_ns_);
  state(wrong_since_ns_);
  state(doubt_since_ns_);
  state(held_since_ns_);
  state(clear_since_ns_);
  state(held_by_);
  state(fault_);
  state(moving_);
  state(late_cycles_);
  state(jerk_);
  state(p_limited_);
}

Eigen::Vector3d Supervisor::Limit(const SupervisedCycle& cycle, Supervision& supervision) {
  const RateLimits& rates = options_.rates;
  Eigen::Vector3d p = *cycle.p_wish;
  const auto took = [&](const Limited& limited, Stop stop) {
    p = limited.p;
    if (!limited.limited || supervision.reaction != Reaction::kNone) return;
    supervision.stop = stop;
    supervision.reaction = Reaction::kLimit;
  };
  if (rates.max_step_m > 0.0 && cycle.p_RW)
    took(LimitStep(*cycle.p_RW, p, rates.max_step_m), Stop::kStep);
  const double dt_s = t_last_ns_ > 0 ? Seconds(cycle.t_ns - t_last_ns_) : 1.0 / options_.rate_hz;
  Eigen::Vector3d from = p_last_.value_or(cycle.p_RW.value_or(p));
  if (jerk_.Limits()) {
    if (!p_limited_) jerk_.Reset(from);
    from = p_limited_.value_or(from);
  }
  if (rates.max_speed_m_s > 0.0) took(LimitSpeed(from, p, dt_s, rates.max_speed_m_s), Stop::kSpeed);
  if (rates.max_acceleration_m_s2 > 0.0) {
    took(LimitAcceleration(from, v_last_m_s_, p, dt_s, rates.max_acceleration_m_s2),
         Stop::kAcceleration);
  }
  v_last_m_s_ = (p - from) / dt_s;
  if (!jerk_.Limits()) return p;
  p_limited_ = p;
  const Eigen::Vector3d smooth = jerk_.Next(p);
  took({smooth, (smooth - p).norm() > kSmoothed_m}, Stop::kJerk);
  return smooth;
}

/// What the wrist waits for, for the next samples to tell.
Stop Supervisor::Doubt(const SupervisedCycle& cycle) {
  Stop doubt = cycle.found.doubt;
  const WristReading wrist = WristOf(cycle);
  if (way_.Beside_m(wrist) > kDoubtful * CommandedWay::AllowedBeside_m(wrist))
    doubt = Stop::kWristNotFollowing;
  if (doubt == Stop::kNone) {
    doubt_since_ns_ = 0;
  } else if (doubt_since_ns_ == 0) {
    doubt_since_ns_ = cycle.t_ns;
  }
  return doubt;
}

/// Whether sensors, or sensors and wrist, have been in doubt in each cycle for so long that it is
/// no chance. A tip that may be astray is another matter: it must move to come back.
bool Supervisor::IsNoChance(Stop doubt, TimeNs t_ns) const {
  return (doubt == Stop::kTipDisagrees || doubt == Stop::kWristNotFollowing) &&
         options_.doubt_s > 0.0 && Seconds(t_ns - doubt_since_ns_) >= options_.doubt_s;
}

/// Hold and fault: entered at once, left when the cause has been gone for long enough, or by a
/// person.
void Supervisor::Judge(const SupervisedCycle& cycle, Decision& decision) {
  Supervision& supervision = decision.supervision;
  const bool cause = supervision.reaction >= Reaction::kHold;
  if (fault_ && cycle.resume) {
    fault_ = false;
    held_since_ns_ = clear_since_ns_ = 0;
    decision.resumed = true;
    if (!cause) return;
  }
  if (cause) {
    if (held_since_ns_ == 0) held_since_ns_ = std::max<TimeNs>(cycle.t_ns, 1);
    clear_since_ns_ = 0;
    held_by_ = supervision.stop;
  } else if (held_since_ns_ != 0 && clear_since_ns_ == 0) {
    clear_since_ns_ = std::max<TimeNs>(cycle.t_ns, 1);
  }
  if (held_since_ns_ == 0) return;
  if (supervision.reaction == Reaction::kFault) fault_ = true;
  if (cause && Seconds(cycle.t_ns - held_since_ns_) > options_.fault_after_s) fault_ = true;
  const bool over = !fault_ && clear_since_ns_ != 0 &&
                    Seconds(cycle.t_ns - clear_since_ns_) >= options_.resume_after_s;
  if (over) {
    held_since_ns_ = clear_since_ns_ = 0;
    return;
  }
  supervision.stop = held_by_;
  supervision.reaction = fault_ ? Reaction::kFault : Reaction::kHold;
}

/// Where a robot that moves is to stop: at once, where its reading lies on the commanded way and
/// the acceleration allows it, else at the last command. A reading may be what is wrong.
std::optional<Eigen::Vector3d> Supervisor::StopAt(const SupervisedCycle& cycle) const {
  if (!p_last_ || !cycle.p_RW || !cycle.p_RW->allFinite()) return p_last_;
  const WristReading wrist = WristOf(cycle);
  const Eigen::Vector3d stop = way_.NearestTo(wrist, *p_last_);
  if ((*cycle.p_RW - stop).norm() > CommandedWay::AllowedBeside_m(wrist)) return p_last_;
  const double a_m_s2 = options_.rates.max_acceleration_m_s2;
  if (a_m_s2 <= 0.0) return stop;
  const double dt_s = std::max(0.0, Seconds(cycle.t_ns - t_last_ns_));
  const double back_m = std::max(0.0, (a_m_s2 * dt_s - v_last_m_s_.norm()) * dt_s);
  const Eigen::Vector3d back = stop - *p_last_;
  return back.norm() <= back_m ? stop : Eigen::Vector3d(*p_last_ + back_m * back.normalized());
}

Supervisor::Decision Supervisor::Decide(const SupervisedCycle& cycle) {
  Decision decision;
  decision.supervision = cycle.found;
  if (options_.kind == SupervisionKind::kNone) {
    decision.p_RW_command = cycle.p_wish;
    return decision;
  }
  if (t_last_ns_ > 0 && cycle.t_ns <= t_last_ns_) {
    decision.supervision.stop = Stop::kBadTime;
    decision.supervision.reaction = Reaction::kHold;
    decision.p_RW_command = p_last_;
    return decision;
  }
  const auto hold = [&](Stop stop) {
    if (decision.supervision.reaction >= Reaction::kHold) return;
    decision.supervision.stop = stop;
    decision.supervision.reaction = Reaction::kHold;
  };
  const bool full = options_.kind == SupervisionKind::kFull;
  const Stop doubt = full ? Doubt(cycle) : Stop::kNone;
  if (full) {
    if (cycle.p_wish && !cycle.p_wish->allFinite()) hold(Stop::kNotFinite);
    if (way_.IsLeft(WristOf(cycle))) hold(Stop::kWristNotFollowing);
    if (IsNoChance(doubt, cycle.t_ns)) hold(doubt);
    const bool is_late =
        t_last_ns_ > 0 && Seconds(cycle.t_ns - t_last_ns_) > kLate / options_.rate_hz;
    late_cycles_ = is_late ? late_cycles_ + 1 : 0;
    if (late_cycles_ >= options_.max_late_cycles) hold(Stop::kDeadline);
    if (!cycle.may_point_wrong) wrong_since_ns_ = 0;
    if (cycle.may_point_wrong && wrong_since_ns_ == 0) wrong_since_ns_ = cycle.t_ns;
    if (wrong_since_ns_ != 0 && Seconds(cycle.t_ns - wrong_since_ns_) > options_.doubt_s)
      hold(Stop::kMotionAngle);
    Judge(cycle, decision);
  } else if (options_.kind == SupervisionKind::kFixedThresholds) {
    Judge(cycle, decision);
  }
  // For a moment the robot only waits: the next estimate may know better.
  Stop waits_for = Stop::kNone;
  if (full) {
    const bool in_doubt =
        doubt != Stop::kNone && Seconds(cycle.t_ns - doubt_since_ns_) < options_.doubt_s;
    if (cycle.tip_is_hidden) waits_for = Stop::kStaleTip;
    if (in_doubt) waits_for = doubt;
    if (cycle.may_point_wrong) waits_for = Stop::kMotionAngle;
  }
  const bool waits = waits_for != Stop::kNone;
  if (waits && decision.supervision.reaction < Reaction::kHold) {
    decision.supervision.stop = waits_for;
    decision.supervision.reaction = Reaction::kLimit;
  }
  decision.supervision.waits = waits || (moving_ && way_.Lags(WristOf(cycle))) ||
                               decision.supervision.reaction >= Reaction::kHold;
  const bool moves = decision.supervision.reaction < Reaction::kHold && !waits && cycle.p_wish &&
                     cycle.p_wish->allFinite();
  if (moves) {
    p_held_.reset();
    decision.p_RW_command = Limit(cycle, decision.supervision);
  } else {
    // The same place all the while: the reading's noise would let the wrist wander.
    // A robot that does not follow, while all sensors agree with where it says it is, stands there:
    // it should not leap once it listens again.
    const bool readable = cycle.p_RW && cycle.p_RW->allFinite();
    const Supervision& found = decision.supervision;
    // In doubt it is the reading that may be wrong.
    const bool stands = found.reaction >= Reaction::kHold &&
                        found.stop == Stop::kWristNotFollowing && found.chi2 > 0.0 &&
                        found.chi2 <= found.chi2_limit;
    if (!p_held_) p_held_ = (moving_ && !stands) || !readable ? StopAt(cycle) : cycle.p_RW;
    // A person may have led the robot elsewhere.
    const bool led =
        decision.resumed && readable && p_held_ &&
        (*cycle.p_RW - *p_held_).norm() > CommandedWay::AllowedBeside_m(WristOf(cycle));
    if (led) p_held_ = cycle.p_RW;
    if (!p_held_ && readable) p_held_ = cycle.p_RW;
    decision.p_RW_command = p_held_;
    const bool leaps = stands && p_last_ && p_held_ && options_.rates.max_acceleration_m_s2 > 0.0;
    if (leaps) {
      const double dt_s = Seconds(cycle.t_ns - t_last_ns_);
      const Eigen::Vector3d from = *p_last_;
      decision.p_RW_command =
          LimitAcceleration(from, v_last_m_s_, *p_held_, dt_s, options_.rates.max_acceleration_m_s2)
              .p;
      v_last_m_s_ = (*decision.p_RW_command - from) / dt_s;
    } else {
      v_last_m_s_.setZero();
    }
  }
  moving_ = moves;
  if (!moves) p_limited_.reset();
  if (decision.p_RW_command) Keep(cycle, *decision.p_RW_command);
  t_last_ns_ = cycle.t_ns;
  return decision;
}

}  // namespace flextip
