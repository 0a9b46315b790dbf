#include "live/loop/holds.h"

#include <algorithm>
#include <array>

namespace flextip::live {
namespace {

constexpr double kFuture_s = 0.1;      // a sample may be so far ahead of the cycle's clock
constexpr double kStateStale_s = 3.0;  // states come once a second

double Seconds(TimeNs span_ns) { return 1e-9 * static_cast<double>(span_ns); }

double Age_s(const Session& session, TimeNs t_ns, TimeNs sample_ns, TimeNs arrived_ns) {
  const double age_s = Seconds(t_ns - sample_ns);
  // In lockstep the robot's time is not that of arrivals.
  return session.robot.lockstep ? age_s : std::max(age_s, Seconds(t_ns - arrived_ns));
}

bool IsStale(const Session& session, const CycleInputs& inputs, StreamName stream) {
  const auto times = TimesIn(inputs.streams, stream);
  if (!times) return true;
  const auto& setup = session.Of(stream);
  const double stale_s = setup ? setup->stale_s : session.camera ? session.camera->stale_s : 0.0;
  const double limit_s = stale_s + session.LatencyOf(stream).value_s;
  return Age_s(session, inputs.t_ns, times->first, times->second) > limit_s;
}

}  // namespace

const char* Name(Hold hold) {
  constexpr std::array names{"none",
                             "bad_time",
                             "source_lost",
                             "stale_wrist",
                             "stale_tip",
                             "not_enabled",
                             "resuming",
                             "starting",
                             "no_goal",
                             "no_command",
                             "not_finite",
                             "stopped",
                             "delay_unknown",
                             "tip_jump",
                             "tip_disagrees",
                             "model_disagrees",
                             "wrist_not_following",
                             "port_moved",
                             "port_depth",
                             "force",
                             "motion_angle",
                             "tip_astray",
                             "deadline"};
  static_assert(names.size() == kHolds);
  return names[static_cast<std::size_t>(hold)];
}

const char* PeerName(int held_by) {
  if (held_by == kRobotPeer) return "robot";
  return held_by == kGoalPeer ? "goal" : Name(static_cast<StreamName>(held_by));
}

Hold HoldBy(Stop stop) {
  switch (stop) {
    case Stop::kNotFinite:
      return Hold::kNotFinite;
    case Stop::kBadTime:
      return Hold::kBadTime;
    case Stop::kStaleWrist:
      return Hold::kStaleWrist;
    case Stop::kStaleTip:
      return Hold::kStaleTip;
    case Stop::kTipJump:
      return Hold::kTipJump;
    case Stop::kTipDisagrees:
      return Hold::kTipDisagrees;
    case Stop::kModelDisagrees:
      return Hold::kModelDisagrees;
    case Stop::kWristNotFollowing:
      return Hold::kWristNotFollowing;
    case Stop::kPortMoved:
      return Hold::kPortMoved;
    case Stop::kPortDepth:
      return Hold::kPortDepth;
    case Stop::kForce:
      return Hold::kForce;
    case Stop::kMotionAngle:
      return Hold::kMotionAngle;
    case Stop::kSourceLost:
      return Hold::kSourceLost;
    case Stop::kTipAstray:
      return Hold::kTipAstray;
    case Stop::kDeadline:
      return Hold::kDeadline;
    default:
      return Hold::kNoCommand;
  }
}

std::optional<std::pair<TimeNs, TimeNs>> TimesIn(const StreamInputs& streams, StreamName stream) {
  const auto times = [](const auto& sample) -> std::optional<std::pair<TimeNs, TimeNs>> {
    if (!sample) return {};
    return std::pair{sample->t_ns, sample->arrived_ns};
  };
  switch (stream) {
    case StreamName::kWrist:
      return times(streams.wrist);
    case StreamName::kTip:
      return times(streams.tip);
    case StreamName::kEm0:
      return times(streams.em0);
    case StreamName::kEm1:
      return times(streams.em1);
    case StreamName::kStrain:
      return times(streams.strain);
    case StreamName::kLoad:
      return times(streams.load);
  }
  return {};
}

Hold FindHold(const Session& session, const CycleInputs& inputs, bool waits, int& held_by) {
  const bool tracks = UsesTipMeasurement(session.task.controller.kind);
  const StreamName tip = session.HasTip() ? StreamName::kTip : StreamName::kEm0;
  for (int i = 0; i < kStreams; ++i) {
    const auto times = TimesIn(inputs.streams, static_cast<StreamName>(i));
    if (times && Seconds(times->first - inputs.t_ns) > kFuture_s) return Hold::kBadTime;
  }
  for (int i = 0; i <= kStreams; ++i) {
    const bool used = i == kRobotPeer || session.streams[static_cast<std::size_t>(i)].has_value();
    if (!used) continue;
    held_by = i;
    if ((inputs.streams.lost >> i & 1U) != 0) return Hold::kSourceLost;
    const auto stream = static_cast<StreamName>(i);
    const bool has_name = i == kRobotPeer || stream == StreamName::kWrist ||
                          stream == StreamName::kTip || (tracks && stream == tip);
    if (!has_name && IsStale(session, inputs, stream)) return Hold::kSourceLost;
  }
  held_by = kGoalPeer;
  if (session.goal && (inputs.streams.lost >> kGoalPeer & 1U) != 0) return Hold::kSourceLost;
  held_by = kRobotPeer;
  if (const auto& state = inputs.streams.state) {
    if (Age_s(session, inputs.t_ns, state->t_ns, state->arrived_ns) > kStateStale_s)
      return Hold::kSourceLost;
  }
  held_by = -1;
  if (IsStale(session, inputs, StreamName::kWrist)) return Hold::kStaleWrist;
  if (tracks && IsStale(session, inputs, tip)) return Hold::kStaleTip;
  if (session.DelayIsUnknown()) return Hold::kDelayUnknown;
  if (session.robot.state) {
    const auto& state = inputs.streams.state;
    if (!state || state->value.state != CrtkState::kEnabled || !state->value.is_homed)
      return Hold::kNotEnabled;
    if (state->value.is_busy && waits) return Hold::kNotEnabled;
  }
  return Hold::kNone;
}

}  // namespace flextip::live
