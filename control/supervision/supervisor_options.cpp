#include "control/supervision/supervisor_options.h"

#include <array>

namespace flextip {
namespace {

constexpr std::array kNames{"none", "rate-limits", "fixed-thresholds", "full"};

}  // namespace

const char* Name(SupervisionKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

std::optional<SupervisionKind> SupervisionKindNamed(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<SupervisionKind>(i);
  }
  return {};
}

}  // namespace flextip
