// Names of the Collaborative Robotics Toolkit (CRTK 1.1): states of a robot and commands for them.
// https://crtk-robotics.readthedocs.io
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace flextip {

enum class CrtkState : std::uint8_t { kDisabled, kEnabled, kPaused, kFault };

enum class CrtkCommand : std::uint8_t { kEnable, kDisable, kPause, kResume, kHome, kUnhome };

/// What a robot says of itself.
struct CrtkOperatingState {
  CrtkState state = CrtkState::kDisabled;
  bool is_homed = false;
  bool is_busy = false;
};

/// Returns "DISABLED", "ENABLED", "PAUSED" or "FAULT".
const char* Name(CrtkState state);
/// Returns "enable", "disable", "pause", "resume", "home" or "unhome".
const char* Name(CrtkCommand command);

/// Return the state or command of a name, nothing for any other text.
std::optional<CrtkState> CrtkStateOf(std::string_view name);
std::optional<CrtkCommand> CrtkCommandOf(std::string_view name);

/// Returns the state as one line of text: "ENABLED homed", "PAUSED homed busy", "DISABLED".
std::string Text(const CrtkOperatingState& state);
/// Returns the state of such a line, nothing for any other text.
std::optional<CrtkOperatingState> CrtkOperatingStateOf(std::string_view text);

}  // namespace flextip
