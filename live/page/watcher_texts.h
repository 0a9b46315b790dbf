// What the page's watchers say, as text. Private to live/page/.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace flextip::live {

/// What a person asks for.
struct PageWish {
  std::string what;  ///< "enable", "pause" or "stop"
  std::string token;
};

/// Reads {"do": "pause", "token": "..."}; nothing where the text is no wish.
std::optional<PageWish> ReadWish(std::string_view text);

/// Reads the number of {"seen": N}, written without blanks; nothing for any other text.
std::optional<long> ReadSeen(std::string_view text);

}  // namespace flextip::live
