// Ctrl-C as a wish to end, for commands that keep what they have.
#pragma once

namespace flextip {

/// While it lives, the first interrupt or termination signal is only noted; the second ends the
/// program as usual.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  static bool Requested();
};

}  // namespace flextip
