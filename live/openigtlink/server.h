// An OpenIGTLink server: the virtual robot's, and that for viewers.
#pragma once

#include <functional>
#include <memory>

#include "live/openigtlink/client.h"
#include "live/wire.h"

namespace flextip::live {

/// Serves up to 16 clients on a thread of its own. All get what is sent. One peer commands, known
/// by its address: the first that sends a message of use, until all its connections that did are
/// gone. Messages of other addresses are refused.
class OpenIgtLinkServer {
 public:
  /// Listens on `port` (0: a free one) of 127.0.0.1, or with `any_address` of every address.
  /// Callbacks as those of OpenIgtLinkClient; kLost comes for each client that left. Throws
  /// WorkError where the port is taken, or without OpenIGTLink.
  OpenIgtLinkServer(int port, bool any_address, std::function<void(WireMessage&&)> message,
                    std::function<void(WireEvent&&)> event);
  ~OpenIgtLinkServer();
  OpenIgtLinkServer(const OpenIgtLinkServer&) = delete;
  OpenIgtLinkServer& operator=(const OpenIgtLinkServer&) = delete;

  /// Sends to all clients; never waits for one. A client that does not read loses messages, whole
  /// ones. Returns the number of clients that the message went to. Throws as the client's Send.
  /// With `keep_for_newcomers` clients that connect later are given it first, until ForgetKept.
  int Send(const WireMessage& message, bool keep_for_newcomers = false);
  void ForgetKept();

  int port() const;
  int Clients() const;
  /// Returns whether a client that sent messages of use is there.
  bool HasCommander() const;
  /// Returns the counts since the start, of all clients.
  WireCounts Counts() const;

 private:
  class Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace flextip::live
