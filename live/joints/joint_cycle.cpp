#include "live/joints/joint_cycle.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "core/error.h"

namespace flextip::live {
namespace {

constexpr double kAskEvery_s = 1.0, kShortestApproach_s = 1.0, kToStart_s = 0.9;
constexpr double kFastestOfQuintic = 1.875;  // of its mean

double Seconds(TimeNs from_ns, TimeNs to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

void RequireLimit(const JointVector& limit, int size, const char* name) {
  if (limit.size() != size || !limit.allFinite() || limit.minCoeff() <= 0.0) {
    throw InputError(
        fmt::format("{}: expected {} numbers above 0, found {}", name, size, limit.size()));
  }
}

}  // namespace

const char* Name(JointHold hold) {
  constexpr std::array names{"none",        "bad_time",    "no_joints",     "stale_joints",
                             "not_enabled", "approaching", "not_following", "bad_command",
                             "stopped",     "done"};
  return names[static_cast<std::size_t>(hold)];
}

JointCycle::JointCycle(const JointModel& model, JointWay way, const JointCycleOptions& options)
    : way_(std::move(way)),
      options_(options),
      feed_forward_(model, options.feed_forward, JointVector::Zero(model.size)) {
  RequireLimit(options.follow_limit, model.size, "follow_limit");
  RequireLimit(options.approach_rate, model.size, "approach_rate");
  JointWish rest = way_.wish(-feed_forward_.Lead_s(), feed_forward_);
  rest.v.setZero();
  rest.a.setZero();
  rest.v_ahead.resize(0);
  // Where the path starts, at rest: the robot is brought there before.
  JointFeedForward still(model, options.feed_forward, rest.q);
  first_ = still.Step(rest, kToStart_s).q;
  feed_forward_ = JointFeedForward(model, options.feed_forward, first_);
  from_ = last_ = first_;
}

bool JointCycle::IsStale(const JointInputs& inputs) const {
  return inputs.lost || Seconds(inputs.measured_ns, inputs.t_ns) > options_.stale_s;
}

/// Of a robot that is moved.
JointHold JointCycle::WhatIsWrong(const JointInputs& inputs) const {
  if (IsStale(inputs)) return JointHold::kStaleJoints;
  if (!inputs.state || inputs.state->state != CrtkState::kEnabled) return JointHold::kNotEnabled;
  if (inputs.q.size() != last_.size() || !inputs.q.allFinite()) return JointHold::kNoJoints;
  if (((inputs.q - last_).cwiseAbs() - options_.follow_limit).maxCoeff() > 0.0)
    return JointHold::kNotFollowing;
  return JointHold::kNone;
}

/// Asks the robot at most so often.
std::optional<CrtkCommand> JointCycle::Ask(TimeNs t_ns, CrtkCommand command) {
  if (asked_ns_ != 0 && Seconds(asked_ns_, t_ns) < kAskEvery_s) return {};
  asked_ns_ = t_ns;
  return command;
}

/// Why a robot that stands is not moved yet.
JointHold JointCycle::Before(const JointInputs& inputs, JointOutputs& outputs) {
  if (inputs.measured_ns == 0 || inputs.q.size() != last_.size() || !inputs.q.allFinite())
    return JointHold::kNoJoints;
  if (IsStale(inputs)) return JointHold::kStaleJoints;
  if (!inputs.state) return JointHold::kNotEnabled;
  const CrtkOperatingState& state = *inputs.state;
  if (state.state == CrtkState::kEnabled && state.is_homed && !state.is_busy)
    return JointHold::kNone;
  if (options_.wait || state.is_busy || state.state == CrtkState::kFault)
    return JointHold::kNotEnabled;
  const CrtkCommand wanted = state.state == CrtkState::kDisabled ? CrtkCommand::kEnable
                             : state.state == CrtkState::kPaused ? CrtkCommand::kResume
                                                                 : CrtkCommand::kHome;
  outputs.state_command = Ask(inputs.t_ns, wanted);
  return JointHold::kNotEnabled;
}

void JointCycle::End(JointHold why, const JointInputs& inputs, JointOutputs& outputs) {
  ended_ = why;
  outputs.hold = why;
  outputs.over = true;
  const bool enabled = inputs.state && inputs.state->state == CrtkState::kEnabled;
  if (enabled && moves_) outputs.state_command = Ask(inputs.t_ns, CrtkCommand::kPause);
}

/// From rest to rest, by a quintic.
void JointCycle::Approach(double t_s, JointOutputs& outputs) {
  const double u = std::clamp(t_s / approach_s_, 0.0, 1.0);
  const double part = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
  outputs.hold = JointHold::kApproaching;
  outputs.q = from_ + part * (first_ - from_);
  outputs.has_command = true;
  if (u >= 1.0) path_s_ = 0.0;
}

void JointCycle::Follow(double dt_s, const JointInputs& inputs, JointOutputs& outputs) {
  const JointWish wish = way_.wish(path_s_, feed_forward_);
  const JointCommand command = feed_forward_.Step(wish, dt_s, inputs.effort);
  outputs.path_s = path_s_;
  if (command.status != FeedForwardStatus::kOk) {
    End(JointHold::kBadCommand, inputs, outputs);
    return;
  }
  outputs.has_command = true;
  outputs.q = command.q;
  outputs.rate_limited = command.rate_limited;
  outputs.correction_limited = command.correction_limited;
  outputs.taking_up = command.taking_up;
  path_s_ += dt_s;
}

JointOutputs JointCycle::Step(const JointInputs& inputs) noexcept {
  JointOutputs outputs;
  outputs.q = last_;
  if (inputs.t_ns <= t_ns_) {
    outputs.hold = JointHold::kBadTime;
    return outputs;
  }
  const double dt_s = t_ns_ == 0 ? 0.0 : Seconds(t_ns_, inputs.t_ns);
  t_ns_ = inputs.t_ns;
  if (ended_ != JointHold::kNone) {
    End(ended_, inputs, outputs);
    return outputs;
  }
  if (inputs.stop || (path_s_ >= 0.0 && path_s_ > way_.seconds)) {
    asked_ns_ = 0;
    End(inputs.stop ? JointHold::kStopped : JointHold::kDone, inputs, outputs);
    return outputs;
  }
  if (!moves_) {
    outputs.hold = Before(inputs, outputs);
    if (outputs.hold != JointHold::kNone) return outputs;
    moves_ = true;
    from_ = last_ = inputs.q;
    approach_ns_ = inputs.t_ns;
    const double slowest =
        (first_ - from_).cwiseAbs().cwiseQuotient(options_.approach_rate).maxCoeff();
    approach_s_ = std::max(kShortestApproach_s, kFastestOfQuintic * slowest);
  } else if (const JointHold wrong = WhatIsWrong(inputs); wrong != JointHold::kNone) {
    asked_ns_ = 0;
    End(wrong, inputs, outputs);
    return outputs;
  }
  if (path_s_ < 0.0) {
    Approach(Seconds(approach_ns_, inputs.t_ns), outputs);
  } else {
    Follow(dt_s, inputs, outputs);
  }
  if (outputs.has_command) last_ = outputs.q;
  return outputs;
}

}  // namespace flextip::live
