// OpenIGTLink messages as bytes: no socket, no state. Lengths on the wire are millimetres; only
// this codec knows that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "live/wire.h"

namespace flextip::live {

/// The longest bodies that are taken (bytes): a header that says more is a lie or an attack.
inline constexpr std::size_t kLongestImage = std::size_t{64} << 20;
inline constexpr std::size_t kLongestBody = std::size_t{1} << 20;

enum class DecodeStatus : std::uint8_t {
  kMore,     ///< the first message is not whole yet
  kDone,     ///< a message was read
  kIgnored,  ///< whole, but of a type without use here
  kRefused,  ///< whole, but damaged or of impossible content; the next message can be read
  kBroken,   ///< this is no OpenIGTLink, or too long: nothing behind it can be trusted
};

struct Decoded {
  DecodeStatus status = DecodeStatus::kMore;
  std::size_t used = 0;  ///< bytes of the message; 0 with kMore and kBroken
  /// One, or with TDATA and QTDATA one a tool; with kRefused the tools that are sound.
  std::vector<WireMessage> messages;
  std::string why;  ///< one line with peer, device and values, for kRefused and kBroken
};

/// Reads the first message of `bytes`: TRANSFORM, POSITION, TDATA, QTDATA as poses, NDARRAY and
/// SENSOR as numbers, STRING as text, STATUS as the text "STATUS code subcode name message", IMAGE
/// of 8 bits with 1 or 3 channels. Header versions 1 to 3; from 2 on with extended header and
/// metadata, which are skipped. Tools of TDATA and QTDATA are devices of their names. Rotations are
/// made exact; one that is off by more than 1e-3 is refused. `peer` is for `why`. Source:
/// OpenIGTLink protocol, http://openigtlink.org/developers/spec
Decoded DecodeOpenIgtLink(std::span<const std::uint8_t> bytes, std::string_view peer);

/// Returns the message as TRANSFORM (32-bit numbers on the wire), NDARRAY of 64-bit numbers,
/// STRING, IMAGE or POLYDATA (a line of 32-bit numbers), with a header of version 1. Throws
/// InputError for device names of no or more than 20 bytes, numbers that are not finite, times
/// before 1970 or after 2106, and what is too long for the type.
std::vector<std::uint8_t> EncodeOpenIgtLink(const WireMessage& message);

/// Convert between nanoseconds since 1970 and OpenIGTLink's seconds with a 32-bit fraction; there
/// and back is exact. `t_ns` is from 0 to the end of OpenIGTLink's time in 2106.
std::uint64_t IgtlStamp(TimeNs t_ns);
TimeNs TimeOfIgtlStamp(std::uint64_t stamp);

}  // namespace flextip::live
