// Lists in messages.
#pragma once

#include <string>
#include <string_view>

namespace flextip::exchange {

/// Appends `item` to `list`, behind a separator where there are items already.
inline void AppendItem(std::string& list, std::string_view item,
                       std::string_view separator = ", ") {
  if (!list.empty()) list += separator;
  list += item;
}

}  // namespace flextip::exchange
