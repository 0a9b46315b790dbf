// Why a robot is held where it is: streams that are lost or late, and the robot's state.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "control/supervision/stops.h"
#include "core/time_series.h"
#include "live/session/session.h"
#include "live/streams/streams.h"

namespace flextip::live {

/// Why the robot is held where it is. The first that applies, in this order but for the last.
/// Recordings have the numbers: new names go to the end.
enum class Hold : std::uint8_t {
  kNone,
  kBadTime,     ///< the cycle's time stands, or a sample is from the future
  kSourceLost,  ///< the peer of a stream is gone, or it has no new sample for longer than its limit
  kStaleWrist,
  kStaleTip,
  kNotEnabled,    ///< the robot is not enabled and homed
  kResuming,      ///< the cause is gone, but not for long enough
  kStarting,      ///< the tip's place is being averaged before the path starts
  kNoGoal,        ///< nothing is wanted of the tip
  kNoCommand,     ///< the controller has none: its status says why
  kNotFinite,     ///< the controller's command is no number
  kStopped,       ///< the operator said stop, or the path is done
  kDelayUnknown,  ///< before kNotEnabled: how old the tip is on arrival is not stated
  // By the supervisor (control/supervision/stops.h).
  kTipJump,
  kTipDisagrees,
  kModelDisagrees,
  kWristNotFollowing,
  kPortMoved,
  kPortDepth,
  kForce,
  kMotionAngle,
  kTipAstray,
  kDeadline,
};
inline constexpr int kHolds = static_cast<int>(Hold::kDeadline) + 1;

/// Returns the name as in recordings and summaries: "stale_wrist".
const char* Name(Hold hold);
/// Returns what CycleOutputs::held_by names: "strain0", "robot", "goal".
const char* PeerName(int held_by);
/// Returns the hold that a stop of the supervisor is.
Hold HoldBy(Stop stop);

struct CycleInputs {
  TimeNs t_ns = 0;  ///< of the cycle (1970)
  StreamInputs streams;
  bool stop = false;  ///< the operator wants an end
};

/// Returns the first cause that the inputs have by themselves: a time, a stream or the robot's
/// state; kNone where there is none. `waits`: the path is not begun, so a busy robot counts as not
/// enabled. `held_by` becomes the stream, with kSourceLost.
Hold FindHold(const Session& session, const CycleInputs& inputs, bool waits, int& held_by);

/// Returns the times of the stream's sample and of its arrival, nothing where there is none.
std::optional<std::pair<TimeNs, TimeNs>> TimesIn(const StreamInputs& streams, StreamName stream);

}  // namespace flextip::live
