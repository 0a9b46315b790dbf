// The state machine of the virtual robot, as CRTK describes it.
#pragma once

#include <optional>

#include "core/robot/crtk.h"
#include "core/time_series.h"

namespace flextip::simulation {

/// Returns the state that `command` leads to, empty where a robot in `state` refuses it. Only a
/// failure leads to FAULT, and only `disable` out of it.
std::optional<CrtkState> StateAfter(CrtkState state, CrtkCommand command);

/// State, homing and their clock.
class CrtkMachine {
 public:
  /// `homing_ns`: how long homing takes.
  explicit CrtkMachine(TimeNs homing_ns) : homing_ns_(homing_ns) {}

  /// Takes a command at the time `t_ns`. Returns false where it is refused. Homing makes the robot
  /// busy, then homed; `disable` in its midst, and `unhome`, leave it not homed.
  bool Take(CrtkCommand command, TimeNs t_ns);
  /// Ends the homing that is due at `t_ns`. Returns whether anything changed.
  bool Advance(TimeNs t_ns);
  /// Something broke: FAULT.
  void Fail();

  const CrtkOperatingState& State() const { return state_; }
  std::optional<TimeNs> NextDue() const { return homed_at_; }
  /// Returns whether set-points move the robot: enabled, homed and not busy.
  bool Follows() const;

 private:
  TimeNs homing_ns_;
  CrtkOperatingState state_;
  std::optional<TimeNs> homed_at_;  // the end of the homing under way
};

}  // namespace flextip::simulation
