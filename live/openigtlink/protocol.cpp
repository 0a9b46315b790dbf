// OpenIGTLink in the list of protocols.
#include "live/protocols/protocol.h"

#include "live/openigtlink/client.h"

namespace flextip::live {
namespace {

class OpenIgtLinkPeer : public PeerConnection {
 public:
  explicit OpenIgtLinkPeer(const PeerWish& wish)
      : client_(AnyOf(wish).host, AnyOf(wish).port, wish.message, wish.event) {}
  bool Send(const WireMessage& message) override { return client_.Send(message); }

 private:
  static const Address& AnyOf(const PeerWish& wish) {
    return wish.in.empty() ? wish.out.front() : wish.in.front();
  }
  OpenIgtLinkClient client_;
};

}  // namespace

extern const Protocol kOpenIgtLinkProtocol{
    .key = "openigtlink",
    .read =
        [](const YamlMap& section, Address& address) {
          constexpr std::size_t kLongestName = 20;  // bytes, in the header of a message
          ReadHostPortDevice(section, kLongestName, address);
        },
    .carries = [](Content content) { return content != Content::kJoints; },
    .takes_commands = true,
    .open = [](const PeerWish& wish) -> std::unique_ptr<PeerConnection> {
      return std::make_unique<OpenIgtLinkPeer>(wish);
    },
};

}  // namespace flextip::live
