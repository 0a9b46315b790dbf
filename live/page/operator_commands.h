// A person's wishes at the page on their way to the cycle's thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "core/robot/crtk.h"
#include "live/streams/samples.h"

namespace flextip::live {

/// The page's thread wants, the cycle's thread asks. Neither waits.
class OperatorCommands {
 public:
  /// The robot is to be paused, and stays so until Enable.
  void Pause() { wish_ = Wish::kPause; }
  /// The robot is to be enabled and homed. A robot in FAULT is not: a person clears it there.
  void Enable() { wish_ = Wish::kEnable; }
  /// The run is to end with the robot paused. Nothing takes it back.
  void Stop() { stop_ = true; }

  bool StopWanted() const { return stop_; }

  /// Returns the command to send to the robot in the cycle of `t_ns`: the person's, said again
  /// until the robot has done it, otherwise the cycle's `own`. A paused robot is not enabled by
  /// the cycle.
  std::optional<CrtkCommand> Next(TimeNs t_ns,
                                  const std::optional<Arrived<CrtkOperatingState>>& state,
                                  const std::optional<CrtkCommand>& own);

 private:
  enum class Wish : std::uint8_t { kNone, kPause, kEnable };

  std::atomic<Wish> wish_{Wish::kNone};
  std::atomic<bool> stop_{false};
  // Of the cycle's thread.
  Wish last_ = Wish::kNone;
  TimeNs wished_ns_ = 0, asked_ns_ = 0;
};

}  // namespace flextip::live
