// The virtual robot's samples as messages: devices and units of docs/live/protocols.md.
#pragma once

#include <optional>

#include "live/wire.h"
#include "simulation/virtual_robot/virtual_robot.h"

namespace flextip::live {

inline constexpr const char* kMeasuredDevice = "PSM1/measured_cp";
inline constexpr const char* kServoDevice = "PSM1/servo_cp";
inline constexpr const char* kInterpolateDevice = "PSM1/interpolate_cp";
inline constexpr const char* kStateDevice = "PSM1/operating_state";
inline constexpr const char* kCommandDevice = "PSM1/state_command";
inline constexpr const char* kLockstepDevice = "lockstep";

/// Returns the tip as 16 numbers: p_RE (mm), covariance row by row (mm2), direction in R (zeros:
/// none), its noise (rad).
WireNumbers TipNumbers(const TipObservation& tip, double direction_noise_rad);

/// Returns the message of a sample, stamped `offset_ns` after the sample's time. Empty for
/// pictures, which are still to be taken, and for tips that are lost.
std::optional<WireMessage> MessageOf(const simulation::VirtualSample& sample,
                                     double direction_noise_rad, TimeNs offset_ns);

}  // namespace flextip::live
