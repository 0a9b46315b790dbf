// Who may ask the page's server for anything.
#include <fmt/format.h>

#include "live/page/server.h"

namespace flextip::live {

bool IsFromHere(std::string_view host, std::string_view origin, int port) {
  for (const char* name : {"127.0.0.1", "localhost"}) {
    const std::string here = fmt::format("{}:{}", name, port);
    // A page of one of the names asks under that name.
    if (host == here && (origin.empty() || origin == "http://" + here)) return true;
  }
  return false;
}

bool SameSecret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned char differ = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    differ = static_cast<unsigned char>(differ | (a[i] ^ b[i]));
  return differ == 0;
}

}  // namespace flextip::live
