#include "live/loop/peers.h"

#include <list>
#include <utility>

namespace flextip::live {
namespace {

class AllPeers : public Peers {
 public:
  AllPeers(const std::vector<Address>& in, const std::vector<Address>& out,
           const PeerHandlers& handlers)
      : handlers_(handlers) {
    for (const Address& address : in) Read(address);
    for (const Address& address : out) Of(address).wish.out.push_back(address);
    Open();
  }

  AllPeers(const Session& session, const PeerHandlers& handlers) : handlers_(handlers) {
    for (const auto& stream : session.streams)
      if (stream) Read(stream->address);
    if (session.camera && session.camera->address) Read(*session.camera->address);
    if (session.goal) Read(*session.goal);
    const RobotSetup& robot = session.robot;
    if (robot.state) Read(*robot.state);
    Of(robot.command).wish.out.push_back(robot.command);
    if (robot.command_state) Of(*robot.command_state).wish.out.push_back(*robot.command_state);
    if (robot.lockstep) {
      PeerWish& wish = Read(*robot.lockstep);
      wish.lockstep = static_cast<int>(wish.in.size()) - 1;
      if (robot.lockstep->SamePeer(robot.command)) wish.answer = 0;
    }
    Open();
  }

  bool Send(const Address& address, const WireMessage& message) override {
    for (Peer& peer : peers_)
      if (peer.address.SamePeer(address)) return peer.connection->Send(message);
    return false;
  }

 private:
  struct Peer {
    Address address;  // its device means nothing
    PeerWish wish;
    std::unique_ptr<PeerConnection> connection;
  };

  void Open() {
    for (Peer& peer : peers_) peer.connection = peer.address.protocol->open(peer.wish);
  }

  PeerWish& Read(const Address& address) {
    PeerWish& wish = Of(address).wish;
    wish.in.push_back(address);
    return wish;
  }

  Peer& Of(const Address& address) {
    for (Peer& peer : peers_)
      if (peer.address.SamePeer(address)) return peer;
    Peer& peer = peers_.emplace_back();
    peer.address = address;
    peer.wish.message = [this, &peer](WireMessage&& m) {
      handlers_.message(peer.address, std::move(m));
    };
    peer.wish.event = [this, &peer](WireEvent&& e) { handlers_.event(peer.address, std::move(e)); };
    return peer;
  }

  PeerHandlers handlers_;
  std::list<Peer> peers_;  // handlers keep references to them
};

}  // namespace

std::unique_ptr<Peers> OpenPeersAt(const std::vector<Address>& in, const std::vector<Address>& out,
                                   const PeerHandlers& handlers) {
  return std::make_unique<AllPeers>(in, out, handlers);
}

std::unique_ptr<Peers> OpenPeersOf(const Session& session, const PeerHandlers& handlers) {
  return std::make_unique<AllPeers>(session, handlers);
}

}  // namespace flextip::live
