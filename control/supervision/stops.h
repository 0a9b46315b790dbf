// The named stops of a control cycle, and what a cycle does about them.
#pragma once

#include <cstdint>

#include "core/state_text.h"

namespace flextip {

/// What the supervisor found. Recordings have the numbers: new names go to the end.
enum class Stop : std::uint8_t {
  kNone,
  kNotFinite,          ///< an input or the command is no number, or its noise is none
  kBadTime,            ///< a time stands, runs backwards, or is from the future
  kStaleWrist,         ///< the wrist repeats itself while it was commanded to move
  kStaleTip,           ///< no new tip for longer than it may be carried on, or it repeats itself
  kSourceLost,         ///< another sensor that is needed is gone
  kTipJump,            ///< the tip is not where the last one and the motion since put it
  kTipDisagrees,       ///< the tip and the other sensors cannot be right together
  kModelDisagrees,     ///< the sensors together no longer fit the instrument
  kWristNotFollowing,  ///< the wrist is not where it was commanded to be
  kPortMoved,          ///< the port has left its registered place
  kPortDepth,          ///< too little shaft before or beyond the port
  kSpeed,              ///< limits of the commanded wrist that acted
  kAcceleration,
  kJerk,
  kStep,
  kWorkspace,    ///< the goal was outside
  kFixture,      ///< the tip is beyond a fixture
  kForce,        ///< the tip presses with more than it may
  kMotionAngle,  ///< the tip might move by more than the limit beside what is wanted
  kDeadline,     ///< a cycle took too long, so many in a row
  kOperator,     ///< a person said stop
  kTipAstray     ///< the tip leaves the way that it was asked to go
};
inline constexpr int kStops = static_cast<int>(Stop::kTipAstray) + 1;

/// Returns the name as in recordings and messages: "tip_jump".
const char* Name(Stop stop);

enum class Reaction : std::uint8_t {
  kNone,
  kLimit,  ///< the command was clipped; the cycle goes on
  kHold,   ///< the wrist stays, the cycle watches and goes on by itself
  kFault   ///< the wrist stays until a person resumes
};
inline constexpr int kReactions = static_cast<int>(Reaction::kFault) + 1;
const char* Name(Reaction reaction);

/// The sensors that are held against each other, as bits of Supervision::voted_out.
enum class VotedSensor : std::uint8_t { kTip, kEm, kPortDirection, kStrain, kLoad, kWristTurn };
inline constexpr int kVotedSensors = static_cast<int>(VotedSensor::kWristTurn) + 1;
const char* Name(VotedSensor sensor);

/// A cycle's findings. Fixed size.
struct Supervision {
  Stop stop = Stop::kNone;  ///< the gravest; with kNone `voted_out` may still warn
  Reaction reaction = Reaction::kNone;
  std::uint8_t voted_out = 0;  ///< bit i: VotedSensor i is not used in this cycle
  double chi2 = 0.0;           ///< of all sensors together; 0: not tested
  double chi2_limit = 0.0;
  double worst_angle_rad = 0.0;  ///< of this step under the model's doubt; 0: not judged
  /// The wrist stays, in a hold or for this cycle alone: the goal should wait for it.
  bool waits = false;
  /// What looks wrong and may be chance: the wrist waits for a moment, for the next samples to
  /// tell.
  Stop doubt = Stop::kNone;

  void VisitState(StateText& state) {
    state(stop);
    state(reaction);
    state(voted_out);
    for (double* value : {&chi2, &chi2_limit, &worst_angle_rad}) state(*value);
    state(waits);
    state(doubt);
  }
};

inline bool IsOut(const Supervision& supervision, VotedSensor sensor) {
  return (supervision.voted_out >> static_cast<int>(sensor) & 1) != 0;
}

}  // namespace flextip
