#include "simulation/virtual_robot/crtk_machine.h"

namespace flextip::simulation {
namespace {

using enum CrtkState;

constexpr std::optional<CrtkState> kRefuses;

/// Rows: DISABLED, ENABLED, PAUSED, FAULT. Columns: enable, disable, pause, resume, home, unhome.
constexpr std::optional<CrtkState> kAfter[4][6] = {
    {kEnabled, kDisabled, kRefuses, kRefuses, kDisabled, kDisabled},
    {kEnabled, kDisabled, kPaused, kEnabled, kEnabled, kEnabled},
    {kRefuses, kDisabled, kPaused, kEnabled, kRefuses, kRefuses},
    {kRefuses, kDisabled, kRefuses, kRefuses, kRefuses, kRefuses},
};

}  // namespace

std::optional<CrtkState> StateAfter(CrtkState state, CrtkCommand command) {
  return kAfter[static_cast<std::size_t>(state)][static_cast<std::size_t>(command)];
}

bool CrtkMachine::Take(CrtkCommand command, TimeNs t_ns) {
  const auto after = StateAfter(state_.state, command);
  if (!after) return false;
  state_.state = *after;
  const bool ends_homing = command == CrtkCommand::kDisable && state_.is_busy;
  if (command == CrtkCommand::kHome) {
    state_.is_homed = false;
    state_.is_busy = true;
    homed_at_ = t_ns + homing_ns_;
  } else if (command == CrtkCommand::kUnhome || ends_homing) {
    state_.is_homed = state_.is_busy = false;
    homed_at_.reset();
  }
  return true;
}

bool CrtkMachine::Advance(TimeNs t_ns) {
  if (!homed_at_ || *homed_at_ > t_ns) return false;
  homed_at_.reset();
  state_.is_busy = false;
  state_.is_homed = true;
  return true;
}

void CrtkMachine::Fail() {
  state_.state = kFault;
  if (state_.is_busy) state_.is_homed = false;
  state_.is_busy = false;
  homed_at_.reset();
}

bool CrtkMachine::Follows() const {
  return state_.state == kEnabled && state_.is_homed && !state_.is_busy;
}

}  // namespace flextip::simulation
