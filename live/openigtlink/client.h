// A client of an OpenIGTLink server: a robot's, a tracker's.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "live/wire.h"

namespace flextip::live {

/// Returns whether this build has OpenIGTLink. Without it clients and servers throw WorkError when
/// they are made.
bool HasOpenIgtLink();

/// Connects, and connects again 0.2 s after each loss, on a thread of its own. Messages of a device
/// come in strictly increasing time; texts may share a time, messages of time 0 always come.
/// Repeated and out-of-order messages are counted and dropped. A new connection starts anew.
class OpenIgtLinkClient {
 public:
  /// Starts the thread. `message` and `event` are called from it, one call at a time, until the
  /// destructor returns; they must not destroy the client. Unreachable peers are one event, not one
  /// every 0.2 s. Throws InputError where `port` is none, WorkError without OpenIGTLink.
  OpenIgtLinkClient(std::string host, int port, std::function<void(WireMessage&&)> message,
                    std::function<void(WireEvent&&)> event);
  ~OpenIgtLinkClient();
  OpenIgtLinkClient(const OpenIgtLinkClient&) = delete;
  OpenIgtLinkClient& operator=(const OpenIgtLinkClient&) = delete;

  /// Gives the message to the system, or queues what does not fit yet; never waits for the peer.
  /// Returns false where there is no connection or the queue is full. Any thread may call it.
  /// Throws InputError for a message that cannot be sent: a name of more than 20 bytes, numbers
  /// that are none.
  bool Send(const WireMessage& message);

  /// Returns the counts since the start, of all connections.
  WireCounts Counts() const;

 private:
  class Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace flextip::live
