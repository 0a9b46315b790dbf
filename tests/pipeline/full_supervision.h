// What tests of the guard share.
#pragma once

#include <cstdint>

#include "control/supervision/stops.h"
#include "control/supervision/supervisor_options.h"

namespace flextip::test_support {

constexpr std::uint8_t Bit(VotedSensor sensor) {
  return static_cast<std::uint8_t>(1U << static_cast<int>(sensor));
}

inline SupervisorOptions Full() {
  SupervisorOptions options;
  options.kind = SupervisionKind::kFull;
  return options;
}

}  // namespace flextip::test_support
