// The page of a running session: one address on this machine shows the run, and lets whoever has
// its token enable, pause and stop (docs/usage/control.md).
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "core/image.h"
#include "live/page/operator_commands.h"
#include "live/page/snapshot.h"
#include "vision/tracking/tip_tracker.h"

namespace flextip::live {

struct PageOptions {
  int port = 0;             ///< 0: a free one
  std::string token;        ///< empty: a random one of 128 bits
  bool can_command = true;  ///< false: the buttons that move the robot are refused
  /// Told in one line what a person asked for, from the page's thread.
  std::function<void(TimeNs t_ns, const std::string& what)> said;
};

class Page {
 public:
  /// Serves on 127.0.0.1 from now on. `session` must outlive the page. Throws WorkError where the
  /// port is taken, or this build has no page.
  Page(const Session& session, PageOptions options);
  ~Page();
  Page(const Page&) = delete;
  Page& operator=(const Page&) = delete;

  int port() const;
  /// Returns the address with the token: whoever has it may command.
  std::string Address() const;

  /// Takes a cycle from the cycle's thread. Never waits, never allocates.
  void Take(const PageSnapshot& snapshot);
  /// Takes a picture with what was found in it, from the camera's thread; most are left out.
  void TakePicture(TimeNs t_ns, const Image& picture, const TipTrack& track);
  /// Takes an event from any thread but the cycle's.
  void TakeEvent(TimeNs t_ns, const std::string& what);
  /// Tells the watchers that the run is over. `done`: its path was run to the end.
  void End(bool done);

  /// The person's wishes, for the cycle's thread.
  OperatorCommands& operators() { return operators_; }

 private:
  class Worker;

  OperatorCommands operators_;
  std::unique_ptr<Worker> worker_;
};

}  // namespace flextip::live
