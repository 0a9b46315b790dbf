// Where a stream comes from, as session files write it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "live/session/session.h"
#include "recording/text/yaml_map.h"

namespace flextip::live {

/// Reads `{openigtlink: {host, port, device}}` or `{udp: {host, port, device}}` of `map`; adds what
/// was read to `sections`. Empty where `map` has neither. Throws InputError with file and line.
std::optional<Address> ReadAddress(const YamlMap& map, std::vector<YamlMap>& sections);

/// Returns "openigtlink 127.0.0.1:18944 em0".
std::string Text(const Address& address);

}  // namespace flextip::live
