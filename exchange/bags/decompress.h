// Compressed chunks of bags.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "exchange/bags/wire.h"

namespace flextip::exchange {

/// Unpacks an lz4 frame ("lz4") or a zstd frame ("zstd") of `size` bytes. Throws WireError for
/// damaged data, and InputError, with the package to install, where this program was built without
/// the library.
std::vector<std::uint8_t> Decompress(Bytes packed, const std::string& compression,
                                     std::uint64_t size);

}  // namespace flextip::exchange
