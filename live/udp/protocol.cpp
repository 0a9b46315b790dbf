// JSON datagrams in the list of protocols.
#include "live/protocols/protocol.h"

#include "live/udp/listener.h"

namespace flextip::live {
namespace {

class UdpPeer : public PeerConnection {
 public:
  explicit UdpPeer(const PeerWish& wish)
      : listener_(wish.in.front().host, wish.in.front().port, wish.message, wish.event) {}
  bool Send(const WireMessage&) override { return false; }

 private:
  UdpListener listener_;
};

}  // namespace

extern const Protocol kUdpProtocol{
    .key = "udp",
    .read =
        [](const YamlMap& section, Address& address) {
          constexpr std::size_t kLongestKey = 200;
          ReadHostPortDevice(section, kLongestKey, address);
        },
    .carries = [](Content content) { return content == Content::kPose; },
    .takes_commands = false,
    .open = [](const PeerWish& wish) -> std::unique_ptr<PeerConnection> {
      return std::make_unique<UdpPeer>(wish);
    },
};

}  // namespace flextip::live
