// Commands that make an arm's true joints the desired ones: what a model of the arm says, inverted.
// Offset, scale, coupling, compliance, servo's lag, droop and inertia by their equations; latency
// by looking ahead; play by crossing it where the motion turns back.
#pragma once

#include <Eigen/Dense>
#include <cstdint>

#include "control/joints/joint_model.h"

namespace flextip {

enum class FeedForwardStatus : std::uint8_t {
  kOk,
  kBadInput,  ///< not finite, absurdly large or of another size: the last command stands
};
const char* Name(FeedForwardStatus status);

/// Desired joints with their rates, `Lead_s()` from now. Fixed-size in memory.
struct JointWish {
  JointVector q, v, a;
  /// Desired rates later still, each joint by its `TurnAhead_s()`: play is crossed half before the
  /// motion turns. Empty: not known, and it is crossed after that.
  JointVector v_ahead;
};

struct JointCommand {
  FeedForwardStatus status = FeedForwardStatus::kBadInput;
  JointVector q;                    ///< finite always
  bool rate_limited = false;        ///< a joint's command may not move as fast as it should
  bool correction_limited = false;  ///< a joint's command may not be as far off the wish
  bool taking_up = false;           ///< a joint is within its play: it does not follow
};

/// One number a joint each; empty: the usual one, in rad or m (a second).
struct FeedForwardOptions {
  double take_up_s = 0.08;       ///< to cross a play, where it is not too wide for that
  JointVector take_up_rate;      ///< fastest crossing; 2 rad/s, 0.2 m/s
  JointVector max_rate;          ///< of a command; 10 rad/s, 1 m/s
  JointVector max_correction;    ///< of a command off its wish; 0.5 rad, 0.05 m
  double effort_memory_s = 0.5;  ///< a measured effort counts by its mean over such a time
};

class JointFeedForward {
 public:
  /// `start`: where the joints are commanded to be. Throws InputError for a model or options whose
  /// sizes differ, are not finite or negative, and where scale and coupling cannot be inverted.
  JointFeedForward(const JointModel& model, const FeedForwardOptions& options,
                   const JointVector& start);

  int Size() const { return model_.size; }
  /// How far ahead of now the wish is.
  double Lead_s() const { return model_.delay_s; }
  /// How far ahead of the wish `v_ahead` is, a joint each.
  const JointVector& TurnAhead_s() const { return turn_ahead_s_; }

  /// Returns the next command, `dt_s` after the last one. `measured_effort` (may be empty) tells
  /// what the model's effort lacks. Bounded, does not allocate, never throws.
  JointCommand Step(const JointWish& wish, double dt_s,
                    const JointVector& measured_effort = {}) noexcept;

 private:
  struct Crossing {
    double from = 0.0, to = 0.0, part = 1.0;  ///< of states; how much of it is done
    double state = 0.0, rate = 0.0;
  };
  bool IsUsable(const JointWish& wish, double dt_s) const;
  JointVector EffortOf(const JointWish& wish, double dt_s, const JointVector& measured);
  void Cross(const JointWish& wish, double dt_s, bool& taking_up);
  void Limit(const JointWish& wish, double dt_s, JointCommand& command);

  JointModel model_;
  FeedForwardOptions options_;
  JointMatrix inverse_;  ///< of scale and coupling
  JointVector turn_ahead_s_, last_, expected_, lacking_, effort_rate_;
  std::array<Crossing, kMaxJoints> crossings_{};
  bool has_expected_ = false;
};

}  // namespace flextip
