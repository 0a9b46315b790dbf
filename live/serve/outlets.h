// Where a served robot's messages go and commands come from: every protocol at once. Private to
// serve.
#pragma once

#include <functional>
#include <optional>

#include "live/dds/node.h"
#include "live/openigtlink/server.h"
#include "live/serve/serve.h"
#include "live/udp/sender.h"
#include "live/wire.h"

namespace flextip::live {

class Outlets {
 public:
  enum class Source { kNobody, kOpenIgtLink, kRos2 };

  /// `message` and `event` are called from a thread of each protocol. Throws as the protocols.
  Outlets(const ServeOptions& options, const std::function<void(Source, WireMessage&&)>& message,
          const std::function<void(WireEvent&&)>& event);

  /// Sends to all who listen. Returns whether somebody does, UDP left out. In lockstep who comes
  /// later is given it too, until ForgetKept.
  bool Send(const WireMessage& message);
  void ForgetKept() { server_.ForgetKept(); }
  /// Waits until all who listen in lockstep have what was sent; false where they do not in 20 ms.
  bool Settled() const;

  /// One peer commands, whatever its protocol. Returns whether that of `source` is heard; it then
  /// commands.
  bool IsHeard(Source source);
  bool HasCommander() const { return HasCommander(commander_); }

  int port() const { return server_.port(); }
  int Clients() const;
  WireCounts Counts() const;

 private:
  bool HasCommander(Source source) const;
  Ros2Setup RosSetup(int domain) const;
  bool HasRosClient() const;

  const ServeOptions& options_;
  Source commander_ = Source::kNobody;
  std::optional<UdpSender> udp_;
  std::optional<Ros2Node> node_;
  OpenIgtLinkServer server_;
};

}  // namespace flextip::live
