// What is asked of the OpenIGTLink codec for any bytes.
#pragma once

#include <cstdint>
#include <span>

namespace flextip {

/// Decodes the bytes and aborts where the codec breaks a promise. The first byte says how the rest
/// is taken: even as it stands, odd as a message whose length and check sum are mended first, which
/// random bytes would never get past. Returns the number of messages read.
int CheckOpenIgtLinkInput(std::span<const std::uint8_t> input);

}  // namespace flextip
