// What is asked of ROS 2's messages for any bytes.
#pragma once

#include <cstdint>
#include <span>

namespace flextip {

/// Reads the bytes behind the first as XCDR1, by the library, and what it makes of them as a
/// message; aborts where the decoder breaks a promise. The first byte says which type (modulo 9),
/// from 128 on big-endian. Returns the number of messages read, 0 or 1.
int CheckRos2Input(std::span<const std::uint8_t> input);

}  // namespace flextip
