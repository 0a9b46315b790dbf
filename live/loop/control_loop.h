// Control of a robot by a session: streams, cycle, clock, robot and recorder together.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "live/camera/tip_camera.h"
#include "live/loop/cycle.h"
#include "live/loop/peers.h"
#include "live/loop/spread.h"
#include "live/page/page.h"
#include "live/recorder/recorder.h"

namespace flextip::live {

struct LoopOptions {
  bool wait = false;                 ///< somebody else homes and enables the robot
  std::optional<double> duration_s;  ///< the end, by the clock; empty: the path's or `stop`'s
  /// The cycles are timed, and the robot is not moved, not even enabled. Set-points go out only
  /// while the robot says that it is not enabled.
  bool only_timing = false;
  std::function<bool()> stop;                        ///< whether the operator wants an end
  std::function<void(const CycleRecord&)> progress;  ///< called after each cycle
  Page* page = nullptr;                              ///< shows the run; null for none
};

struct LoopReport {
  long cycles = 0, missed = 0;  ///< missed: of the clock, because a cycle took too long
  long unsent = 0;              ///< set-points that no peer took
  double seconds = 0.0;
  bool done = false;                  ///< the path was run to its end
  bool ends_paused = false;           ///< the robot said at the end that it is not enabled
  bool had_priority = false;          ///< the system gave the cycle real-time priority
  bool had_locked_memory = false;     ///< and kept its memory in place
  Spread sample_to_command;           ///< from the newest wrist's time to the command sent
  Spread wake;                        ///< from the cycle's due time to its begin
  Spread work;                        ///< from the cycle's begin to the command sent
  std::map<std::string, long> holds;  ///< cycles by the name of their hold
  long step_limited = 0, speed_limited = 0, acceleration_limited = 0, workspace_limited = 0,
       fixture_limited = 0;
  std::array<StreamCounts, kStreams> streams;
  std::optional<CameraCounts> camera;  ///< where the session has one
  long bad_states = 0;
  std::string last_hold;        ///< of the last cycle
  std::vector<Warning> causes;  ///< each time that others were named; at most 16
};

/// Runs the session until its path is done, the time is over or the operator stops it; then pauses
/// the robot. `recorder`: null for none. Throws WorkError where peers cannot be opened.
LoopReport RunLoop(const Session& session, const LoopOptions& options, Recorder* recorder,
                   const OpenPeers& open = OpenPeersOf);

}  // namespace flextip::live
