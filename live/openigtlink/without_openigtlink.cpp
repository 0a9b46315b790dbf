// In the place of client.cpp and server.cpp where there is no OpenIGTLink.
#include "core/error.h"
#include "live/openigtlink/client.h"
#include "live/openigtlink/server.h"

namespace flextip::live {
namespace {

[[noreturn]] void Missing() {
  throw WorkError("this program was built without OpenIGTLink (Debian's libopenigtlink-dev)");
}

}  // namespace

class OpenIgtLinkClient::Worker {};
class OpenIgtLinkServer::Worker {};

bool HasOpenIgtLink() { return false; }

OpenIgtLinkClient::OpenIgtLinkClient(std::string, int, std::function<void(WireMessage&&)>,
                                     std::function<void(WireEvent&&)>) {
  Missing();
}
OpenIgtLinkClient::~OpenIgtLinkClient() = default;
bool OpenIgtLinkClient::Send(const WireMessage&) { return false; }
WireCounts OpenIgtLinkClient::Counts() const { return {}; }

OpenIgtLinkServer::OpenIgtLinkServer(int, bool, std::function<void(WireMessage&&)>,
                                     std::function<void(WireEvent&&)>) {
  Missing();
}
OpenIgtLinkServer::~OpenIgtLinkServer() = default;
int OpenIgtLinkServer::Send(const WireMessage&, bool) { return 0; }
void OpenIgtLinkServer::ForgetKept() {}
int OpenIgtLinkServer::port() const { return 0; }
int OpenIgtLinkServer::Clients() const { return 0; }
bool OpenIgtLinkServer::HasCommander() const { return false; }
WireCounts OpenIgtLinkServer::Counts() const { return {}; }

}  // namespace flextip::live
