// What is asked of the reader of JSON datagrams for any bytes.
#pragma once

#include <cstdint>
#include <span>

namespace flextip {

/// Reads the bytes as a datagram and aborts where the reader breaks a promise. Returns the number
/// of poses read.
int CheckUdpInput(std::span<const std::uint8_t> input);

}  // namespace flextip
