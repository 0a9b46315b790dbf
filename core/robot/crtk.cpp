#include "core/robot/crtk.h"

#include <array>
#include <cstddef>

namespace flextip {
namespace {

constexpr std::array kStates{"DISABLED", "ENABLED", "PAUSED", "FAULT"};
constexpr std::array kCommands{"enable", "disable", "pause", "resume", "home", "unhome"};

template <class Enum, class Names>
std::optional<Enum> Find(const Names& names, std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (name == names[i]) return static_cast<Enum>(i);
  }
  return {};
}

/// Takes the first word off `text`.
std::string_view TakeWord(std::string_view& text) {
  const std::size_t end = text.find(' ');
  const std::string_view word = text.substr(0, end);
  text = end == std::string_view::npos ? std::string_view() : text.substr(end + 1);
  return word;
}

}  // namespace

const char* Name(CrtkState state) { return kStates[static_cast<std::size_t>(state)]; }
const char* Name(CrtkCommand command) { return kCommands[static_cast<std::size_t>(command)]; }

std::optional<CrtkState> CrtkStateOf(std::string_view name) {
  return Find<CrtkState>(kStates, name);
}

std::optional<CrtkCommand> CrtkCommandOf(std::string_view name) {
  return Find<CrtkCommand>(kCommands, name);
}

std::string Text(const CrtkOperatingState& state) {
  return std::string(Name(state.state)) + (state.is_homed ? " homed" : "") +
         (state.is_busy ? " busy" : "");
}

std::optional<CrtkOperatingState> CrtkOperatingStateOf(std::string_view text) {
  const auto state = CrtkStateOf(TakeWord(text));
  if (!state) return {};
  CrtkOperatingState found{*state};
  while (!text.empty()) {
    const std::string_view word = TakeWord(text);
    if (word == "homed" && !found.is_homed && !found.is_busy) {
      found.is_homed = true;
    } else if (word == "busy" && !found.is_busy) {
      found.is_busy = true;
    } else {
      return {};
    }
  }
  return found;
}

}  // namespace flextip
