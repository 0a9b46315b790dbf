#include "live/session/address.h"

#include <fmt/format.h>

namespace flextip::live {

std::optional<Address> ReadAddress(const YamlMap& map, std::vector<YamlMap>& sections,
                                   Content content) {
  std::optional<Address> found;
  for (const Protocol* const protocol : Protocols()) {
    if (!map.Has(protocol->key)) continue;
    if (found) throw map.Error(protocol->key, "found two sources, expected one");
    if (!protocol->carries(content))
      throw map.Error(protocol->key, "does not carry this, expected another protocol");
    sections.push_back(map.Map(protocol->key));
    found.emplace();
    found->protocol = protocol;
    found->content = content;
    protocol->read(sections.back(), *found);
  }
  return found;
}

std::string Text(const Address& address) {
  return fmt::format("{} {}:{} {}", address.protocol->key, address.host, address.port,
                     address.device);
}

}  // namespace flextip::live
