// The cycle as the page shows it: copied by the cycle's thread, so of a fixed size.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/robot/crtk.h"
#include "live/recorder/cycle_record.h"

namespace flextip::live {

struct PageSnapshot {
  CycleRecord record;
  ControllerCommand command;  ///< behind the record: a late tip is carried on to its time
  bool on_path = false;       ///< the path is begun; the next two mean something
  Eigen::Vector3d p_RE_start = Eigen::Vector3d::Zero();  ///< of the path (m, in R)
  double deviation_m = 0.0;                              ///< of the known tip from the path so far
  long cycles = 0, missed = 0;
  std::array<long, kStreams> accepted{};  ///< samples of each stream so far
};

/// A change of hold or robot, or a command to the robot. None is lost between two snapshots.
struct PageChange {
  TimeNs t_ns = 0;
  Hold hold = Hold::kNone;
  int held_by = -1;
  std::optional<CrtkOperatingState> state;
  std::optional<CrtkCommand> told;  ///< by the cycle
  FoundCause cause;                 ///< where it is there, that it was found is what happened
};

/// Something that happened.
struct PageEvent {
  enum class Kind : std::uint8_t { kChange, kWish, kText };
  TimeNs t_ns = 0;
  Kind kind = Kind::kText;
  std::string text;   ///< a line, or what a person wished: "pause"
  PageChange change;  ///< with kChange
  long n = 0;         ///< its number, from 1
};

}  // namespace flextip::live
