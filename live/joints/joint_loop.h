// Moves the robot of a joint session: connections, clock, cycle, and a record of every cycle.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "live/joints/joint_cycle.h"
#include "live/joints/joint_session.h"
#include "live/loop/peers.h"

namespace flextip::live {

struct JointRecord {
  JointInputs inputs;
  JointOutputs outputs;
  bool sent = false;
};

struct JointLoopOptions {
  std::optional<double> duration_s;
  std::function<bool()> stop;         ///< asked every cycle; true: the robot is paused
  std::size_t most_cycles = 600'000;  ///< that are kept
};

struct JointLoopReport {
  std::deque<JointRecord> cycles;   ///< the first `most_cycles`
  std::vector<std::string> events;  ///< of the connections, one line each
  JointHold last_hold = JointHold::kNone;
  long cycle_count = 0, missed = 0, unsent = 0, limited = 0, bad_messages = 0;
  bool done = false;  ///< the whole path was gone
};

using OpenJointPeers = std::function<std::unique_ptr<Peers>(
    const std::vector<Address>& in, const std::vector<Address>& out, const PeerHandlers& handlers)>;

/// Runs until the path is done, something goes wrong, or the options say so; the robot is paused
/// then. Throws WorkError where this build lacks the protocol.
JointLoopReport RunJoints(const JointSession& session, JointCycle cycle, int joints,
                          const JointLoopOptions& options, const OpenJointPeers& open = nullptr);

}  // namespace flextip::live
