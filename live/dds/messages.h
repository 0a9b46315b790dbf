// ROS 2's messages, as the structs that idlc makes of ros2.idl, from and to WireMessage. No entity
// of DDS, no state.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "live/dds/types.h"
#include "live/wire.h"

namespace flextip::live {

/// A message that was read, or the reason why it is refused: one line of printable characters with
/// the values found. Both empty: nothing to say.
struct Ros2Decoded {
  std::optional<WireMessage> message;
  std::string why;
};

/// Reads `sample`, a struct of `type`. Orientations must be unit quaternions within 1e-3 and
/// numbers finite; quaternions are made exact. A stamp of 0 is time 0: invalid data.
/// `source_ns`: the time of a type that has none. Content by type: poses; of
/// PoseWithCovarianceStamped the 16 numbers of vision0 (docs/live/protocols.md); the effort of
/// JointState, or its positions and efforts; the force of WrenchStamped; texts; pictures in mono8,
/// bgr8 or rgb8.
Ros2Decoded DecodeRos2(Ros2Type type, const void* sample, std::string_view device,
                       TimeNs source_ns);

/// Calls `use` with the message as a struct of `type`. Throws InputError for a body that `type`
/// does not carry, numbers that are not finite, times before 1970 or after 2038, and texts with a
/// character 0.
void WithRos2(Ros2Type type, const WireMessage& message,
              const std::function<void(const void*)>& use);

}  // namespace flextip::live
