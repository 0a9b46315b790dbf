// What is asked of an OpenIGTLink connection, whatever its peer sends and however it is cut.
#pragma once

#include <cstdint>
#include <span>

namespace flextip {

/// Plays a peer that sends what the bytes say, in pieces, reads nothing until the end, and closes.
/// Aborts where the connection breaks a promise: what arrives does not depend on the pieces, is
/// counted once, is late after 2 s exactly where a message is under way, and what was accepted for
/// sending arrives whole and in order. The input is a row of acts of two bytes, kind and size, and
/// as many bytes as the size says: as they stand (0), a message with its length and check sum
/// mended (1), a pose (2), to be sent to the peer (3). Returns the number of messages that arrived.
int CheckConnectionInput(std::span<const std::uint8_t> input);

}  // namespace flextip
