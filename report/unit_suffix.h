// The unit a name ends with, and how people read it. Private to this folder.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <string_view>

namespace flextip::report {

struct UnitSuffix {
  std::string_view ending;  ///< "_Nm"
  std::string_view shown;   ///< "mN m"
  double factor;            ///< from the name's unit to the one shown
};

/// The first that `name` ends with, longer endings standing before those they end with; else null.
inline const UnitSuffix* SuffixOf(const std::string& name, std::span<const UnitSuffix> suffixes) {
  const auto it = std::find_if(suffixes.begin(), suffixes.end(),
                               [&](const UnitSuffix& u) { return name.ends_with(u.ending); });
  return it == suffixes.end() ? nullptr : &*it;
}

}  // namespace flextip::report
