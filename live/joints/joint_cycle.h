// One cycle at an arm's joints, as a function of its inputs and its own state: no clock, no socket,
// nothing allocated. It waits for an enabled robot, brings the joints to where the desired path
// starts, and follows it by the feed-forward. What it sees go wrong on the way pauses the robot for
// good: a person looks, and starts anew.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <functional>
#include <optional>

#include "control/joints/joint_feed_forward.h"
#include "core/robot/crtk.h"
#include "core/time_series.h"

namespace flextip::live {

/// Why joints are not moved along their path. Recordings have the numbers.
enum class JointHold : std::uint8_t {
  kNone,
  kBadTime,       ///< the cycle's time stands or runs backwards
  kNoJoints,      ///< nothing was measured yet
  kStaleJoints,   ///< no new measured joints for longer than the limit, or the peer is gone
  kNotEnabled,    ///< the robot is not enabled and homed
  kApproaching,   ///< on the way to where the path starts
  kNotFollowing,  ///< a measured joint is too far from its command
  kBadCommand,    ///< the feed-forward has none
  kStopped,       ///< the operator said stop
  kDone,
};
/// Returns the name as in recordings: "not_following".
const char* Name(JointHold hold);

/// The desired path, from time 0. It should begin at rest: the joints stand where it starts.
struct JointWay {
  /// What the feed-forward wants to know at a time of the path. May neither allocate nor throw.
  std::function<JointWish(double t_s, const JointFeedForward& feed_forward)> wish;
  double seconds = 0.0;
};

struct JointCycleOptions {
  double stale_s = 0.05;
  JointVector follow_limit;   ///< of a measured joint off its command (rad, m)
  JointVector approach_rate;  ///< fastest on the way to the start
  bool wait = false;          ///< somebody else homes and enables the robot
  FeedForwardOptions feed_forward;
};

/// What a cycle is given. Fixed size.
struct JointInputs {
  TimeNs t_ns = 0;
  TimeNs measured_ns = 0;  ///< when the newest joints arrived; 0: none did
  JointVector q, effort;   ///< as measured; the effort may be empty
  std::optional<CrtkOperatingState> state;
  bool lost = false;  ///< the robot's connection
  bool stop = false;  ///< the operator wants an end
};

struct JointOutputs {
  JointHold hold = JointHold::kNone;
  bool has_command = false;
  JointVector q;  ///< of the command
  std::optional<CrtkCommand> state_command;
  double path_s = -1.0;  ///< where on the path; -1: not on it
  bool rate_limited = false, correction_limited = false, taking_up = false;
  bool over = false;  ///< done, stopped or gone wrong: nothing will be commanded any more
};

class JointCycle {
 public:
  /// Throws InputError for options of another size, and as JointFeedForward.
  JointCycle(const JointModel& model, JointWay way, const JointCycleOptions& options);

  /// Never throws.
  JointOutputs Step(const JointInputs& inputs) noexcept;

 private:
  JointHold Before(const JointInputs& inputs, JointOutputs& outputs);
  JointHold WhatIsWrong(const JointInputs& inputs) const;
  bool IsStale(const JointInputs& inputs) const;
  void Approach(double t_s, JointOutputs& outputs);
  void Follow(double dt_s, const JointInputs& inputs, JointOutputs& outputs);
  void End(JointHold why, const JointInputs& inputs, JointOutputs& outputs);
  std::optional<CrtkCommand> Ask(TimeNs t_ns, CrtkCommand command);

  JointWay way_;
  JointCycleOptions options_;
  JointFeedForward feed_forward_;
  JointVector first_;  ///< the first command of the path
  JointVector from_, last_;
  TimeNs t_ns_ = 0, approach_ns_ = 0, asked_ns_ = 0;
  double approach_s_ = 0.0, path_s_ = -1.0;
  bool moves_ = false;
  JointHold ended_ = JointHold::kNone;
};

}  // namespace flextip::live
