// In the place of server.cpp where there is no websocketpp.
#include "core/error.h"
#include "live/page/server.h"

namespace flextip::live {

class PageServer::Worker {};

bool HasPage() { return false; }

PageServer::PageServer(int, std::vector<ServedFile>, ServerHandlers, double) {
  throw WorkError("this program was built without the page (Debian's libwebsocketpp-dev)");
}
PageServer::~PageServer() = default;
int PageServer::port() const { return 0; }
int PageServer::Watchers() const { return 0; }
void PageServer::SendText(long, const std::string&) {}
void PageServer::SendBytes(long, const std::string&) {}

}  // namespace flextip::live
