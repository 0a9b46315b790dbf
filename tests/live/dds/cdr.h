// Bytes of XCDR1 as ROS 2's messages and back, by Cyclone DDS itself.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "live/dds/types.h"
#include "live/wire.h"

namespace flextip::live {

/// Calls `use` with the message as a struct of `type`, where the library takes the bytes (behind
/// the header of four).
void WithCdr(Ros2Type type, std::span<const std::uint8_t> bytes, bool big_endian,
             const std::function<void(const void*)>& use);

/// Returns the bytes that the library makes of a message, header and padding left out.
std::vector<std::uint8_t> CdrOf(Ros2Type type, const WireMessage& message);

/// Returns the name of the type as it goes over the wire.
const char* WireName(Ros2Type type);

}  // namespace flextip::live
