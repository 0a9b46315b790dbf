// Where a stream comes from, as session files write it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "live/protocols/protocol.h"

namespace flextip::live {

/// Reads `{openigtlink: {host, port, device}}`, or that of another protocol, of `map`; adds what
/// was read to `sections`. Empty where `map` has none. Throws InputError with file and line, also
/// for a protocol that does not carry `content`.
std::optional<Address> ReadAddress(const YamlMap& map, std::vector<YamlMap>& sections,
                                   Content content = Content::kPose);

/// Returns "openigtlink 127.0.0.1:18944 em0".
std::string Text(const Address& address);

}  // namespace flextip::live
