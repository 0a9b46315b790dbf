// The connections of a session: whose messages come, and where commands go.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "live/session/session.h"
#include "live/wire.h"

namespace flextip::live {

class Peers {
 public:
  virtual ~Peers() = default;
  /// Gives the message to the system; never waits. Returns false where the peer is not there.
  virtual bool Send(const Address& address, const WireMessage& message) = 0;

 protected:
  Peers() = default;
  Peers(const Peers&) = default;
  Peers& operator=(const Peers&) = default;
};

/// Called from the peers' own threads, one call at a time for a peer. `device` of the address means
/// nothing here.
struct PeerHandlers {
  std::function<void(const Address& peer, WireMessage&& message)> message;
  std::function<void(const Address& peer, WireEvent&& event)> event;
};

using OpenPeers =
    std::function<std::unique_ptr<Peers>(const Session& session, const PeerHandlers& handlers)>;

/// Connects to the peers of these addresses, once each. Throws WorkError where this build lacks the
/// protocol.
std::unique_ptr<Peers> OpenPeersAt(const std::vector<Address>& in, const std::vector<Address>& out,
                                   const PeerHandlers& handlers);

/// Connects to every peer that the session names, once each. Throws WorkError where this build
/// lacks the protocol.
std::unique_ptr<Peers> OpenPeersOf(const Session& session, const PeerHandlers& handlers);

}  // namespace flextip::live
