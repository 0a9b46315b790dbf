#pragma once

namespace flextip {

/// The program's version, as in CMakeLists.txt.
inline constexpr const char* kVersion = FLEXTIP_VERSION;

}  // namespace flextip
