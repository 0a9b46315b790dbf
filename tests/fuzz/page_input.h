// What is asked of the reader of watchers' texts for any bytes.
#pragma once

#include <cstdint>
#include <span>

namespace flextip {

/// Reads the bytes as a watcher's text, and as a request's host and origin (split at the first line
/// break). Aborts where a reader breaks a promise. Returns 1 where the text was understood.
int CheckPageInput(std::span<const std::uint8_t> input);

}  // namespace flextip
