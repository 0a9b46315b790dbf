#include "live/loop/peers.h"

#include <list>

#include "live/openigtlink/client.h"
#include "live/udp/listener.h"

namespace flextip::live {
namespace {

class AllPeers : public Peers {
 public:
  AllPeers(const Session& session, const PeerHandlers& handlers) : handlers_(handlers) {
    for (const auto& stream : session.streams)
      if (stream) Open(stream->address);
    if (session.camera && session.camera->address) Open(*session.camera->address);
    Open(session.robot.command);
    if (session.goal) Open(*session.goal);
    for (const auto& address :
         {session.robot.state, session.robot.command_state, session.robot.lockstep})
      if (address) Open(*address);
  }

  bool Send(const Address& address, const WireMessage& message) override {
    for (Connection& connection : connections_)
      if (connection.address.SamePeer(address) && connection.client)
        return connection.client->Send(message);
    return false;
  }

 private:
  struct Connection {
    Address address;
    std::unique_ptr<OpenIgtLinkClient> client;
    std::unique_ptr<UdpListener> listener;
  };

  void Open(const Address& address) {
    for (const Connection& connection : connections_)
      if (connection.address.SamePeer(address)) return;
    Connection& connection = connections_.emplace_back();
    connection.address = address;
    const auto message = [this, &connection](WireMessage&& m) {
      handlers_.message(connection.address, std::move(m));
    };
    const auto event = [this, &connection](WireEvent&& e) {
      handlers_.event(connection.address, std::move(e));
    };
    if (address.transport == Transport::kUdp) {
      connection.listener =
          std::make_unique<UdpListener>(address.host, address.port, message, event);
    } else {
      connection.client =
          std::make_unique<OpenIgtLinkClient>(address.host, address.port, message, event);
    }
  }

  PeerHandlers handlers_;
  std::list<Connection> connections_;  // handlers keep references to them
};

}  // namespace

std::unique_ptr<Peers> OpenPeersOf(const Session& session, const PeerHandlers& handlers) {
  return std::make_unique<AllPeers>(session, handlers);
}

}  // namespace flextip::live
