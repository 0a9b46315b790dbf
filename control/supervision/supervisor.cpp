#include "control/supervision/supervisor.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "control/supervision/rate_limits.h"
#include "core/error.h"

namespace flextip {
namespace {

double Seconds(TimeNs span_ns) { return 1e-9 * static_cast<double>(span_ns); }

/// The distance of `p` from the segment from `a` to `b`.
double DistanceFrom(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& p) {
  const Eigen::Vector3d way = b - a;
  const double length2 = way.squaredNorm();
  const double along = length2 > 0.0 ? std::clamp((p - a).dot(way) / length2, 0.0, 1.0) : 0.0;
  return (p - a - along * way).norm();
}

// Of three components at once, each normal, less than one in 1e7 is this many deviations long.
constexpr double kDeviations = 6.0;
constexpr double kSettle_m = 0.0005;  // a servo may stay so far from its set-point

}  // namespace

void Supervisor::Keep(const SupervisedCycle& cycle, const Eigen::Vector3d& p_RW) {
  sent_[next_] = {cycle.t_ns, p_RW, cycle.p_RW.value_or(p_RW)};
  next_ = (next_ + 1) % kSize;
  count_ = std::min(count_ + 1, kSize);
  p_last_ = p_RW;
}

void Supervisor::NoteSent(const Eigen::Vector3d& p_RW) {
  if (count_ == 0 || !p_RW.allFinite()) return;
  sent_[(next_ + kSize - 1) % kSize].p_RW = p_RW;
  p_last_ = p_RW;
  if (p_held_) p_held_ = p_RW;
}

void Supervisor::VisitState(StateText& state) {
  state(next_);
  state(count_);
  if (next_ >= kSize || count_ > kSize) throw InputError("saved state: no place in a ring");
  for (std::size_t i = 1; i <= count_; ++i) state(sent_[(next_ + kSize - i) % kSize]);
  state(p_last_);
  state(p_held_);
  state(v_last_m_s_);
  state(t_last_ns_);
  state(wrong_since_ns_);
  state(held_since_ns_);
  state(clear_since_ns_);
  state(held_by_);
  state(fault_);
  state(moving_);
}

bool Supervisor::IsAstray(const SupervisedCycle& cycle) const {
  if (!cycle.p_RW || count_ == 0) return false;
  const double allowed_m = kSettle_m + kDeviations * std::sqrt(2.0) * cycle.p_RW_noise_m;
  const Sent& newest = sent_[(next_ + kSize - 1) % kSize];
  const double moved_m = (*cycle.p_RW - newest.p_RW_before).norm();
  double nearest_m = std::numeric_limits<double>::infinity(), farthest_m = 0.0, away_m = 0.0;
  std::optional<Eigen::Vector3d> later;
  for (std::size_t i = 1; i <= count_; ++i) {
    const Sent& sent = sent_[(next_ + kSize - i) % kSize];
    nearest_m =
        std::min(nearest_m, DistanceFrom(sent.p_RW, later.value_or(sent.p_RW), *cycle.p_RW));
    farthest_m = std::max(farthest_m, (sent.p_RW - newest.p_RW_before).norm());
    away_m = std::max(away_m, (sent.p_RW_before - *cycle.p_RW).norm());
    later = sent.p_RW;
    // The command of before the lag counts: the robot may only now leave it.
    if (Seconds(cycle.t_ns - sent.t_ns) <= options_.follow_lag_s) continue;
    const bool stands = nearest_m > allowed_m && away_m < allowed_m;
    return stands || moved_m > farthest_m + allowed_m;
  }
  // Not commanded for long enough yet to say.
  return false;
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
  const Eigen::Vector3d from = p_last_.value_or(cycle.p_RW.value_or(p));
  if (rates.max_speed_m_s > 0.0) took(LimitSpeed(from, p, dt_s, rates.max_speed_m_s), Stop::kSpeed);
  if (rates.max_acceleration_m_s2 > 0.0) {
    took(LimitAcceleration(from, v_last_m_s_, p, dt_s, rates.max_acceleration_m_s2),
         Stop::kAcceleration);
  }
  v_last_m_s_ = (p - from) / dt_s;
  return p;
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
  if (options_.kind == SupervisionKind::kFull) {
    if (cycle.p_wish && !cycle.p_wish->allFinite()) hold(Stop::kNotFinite);
    if (IsAstray(cycle)) hold(Stop::kWristNotFollowing);
    if (!cycle.may_point_wrong) wrong_since_ns_ = 0;
    if (cycle.may_point_wrong && wrong_since_ns_ == 0) wrong_since_ns_ = cycle.t_ns;
    if (wrong_since_ns_ != 0 && Seconds(cycle.t_ns - wrong_since_ns_) > options_.resume_after_s)
      hold(Stop::kMotionAngle);
    Judge(cycle, decision);
  } else if (options_.kind == SupervisionKind::kFixedThresholds) {
    Judge(cycle, decision);
  }
  // For a moment the robot only waits: the next estimate may know better.
  const bool waits = options_.kind == SupervisionKind::kFull && cycle.may_point_wrong;
  if (waits && decision.supervision.reaction == Reaction::kNone) {
    decision.supervision.stop = Stop::kMotionAngle;
    decision.supervision.reaction = Reaction::kLimit;
  }
  const bool moves = decision.supervision.reaction < Reaction::kHold && !waits && cycle.p_wish &&
                     cycle.p_wish->allFinite();
  if (moves) {
    p_held_.reset();
    decision.p_RW_command = Limit(cycle, decision.supervision);
  } else {
    // While it moved, the last command: a reading may be what is wrong. Else the wrist as measured
    // when the hold began, since its noise would let it wander.
    const bool readable = cycle.p_RW && cycle.p_RW->allFinite();
    if (!p_held_) p_held_ = moving_ || !readable ? p_last_ : cycle.p_RW;
    if (decision.resumed && readable) p_held_ = cycle.p_RW;
    if (!p_held_ && readable) p_held_ = cycle.p_RW;
    decision.p_RW_command = p_held_;
    v_last_m_s_.setZero();
  }
  moving_ = moves;
  if (decision.p_RW_command) Keep(cycle, *decision.p_RW_command);
  t_last_ns_ = cycle.t_ns;
  return decision;
}

}  // namespace flextip
