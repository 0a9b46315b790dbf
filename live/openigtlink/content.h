// The content of OpenIGTLink messages behind the header. Private to the codec.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "live/wire.h"

namespace flextip::live {

/// The reason why a content is refused, without peer and device.
struct RefusedContent {
  std::string device;  ///< empty: the header's
  std::string why;
};

/// Where the content of a message goes.
struct ContentSink {
  std::string device;
  TimeNs t_ns = 0;
  std::vector<WireMessage> messages;
  std::vector<RefusedContent> refused;
};

/// Whether `size` bytes can be a content of `type`; `content` is read as far as lengths stand in
/// it.
bool ContentFits(std::string_view type, std::span<const std::uint8_t> content);

/// Whether there is a reader for the type.
bool IsKnownType(std::string_view type);

/// Reads a content for which ContentFits is true.
void ReadContent(std::string_view type, std::span<const std::uint8_t> content, ContentSink& sink);

}  // namespace flextip::live
