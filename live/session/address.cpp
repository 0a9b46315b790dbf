#include "live/session/address.h"

#include <fmt/format.h>

namespace flextip::live {
namespace {

constexpr std::size_t kLongestOpenIgtLinkName = 20;  // bytes, in the header of a message

std::optional<Address> Read(const YamlMap& map, const std::string& key, Transport transport,
                            std::vector<YamlMap>& sections) {
  if (!map.Has(key)) return {};
  sections.push_back(map.Map(key));
  const YamlMap section = sections.back();
  Address address;
  address.transport = transport;
  address.host = section.TextOr("host", address.host);
  const std::int64_t port = section.Integer("port");
  if (port < 1 || port > 65535) {
    throw section.Error("port", fmt::format("found {}, expected 1 to 65535", port));
  }
  address.port = static_cast<int>(port);
  address.device = section.Text("device");
  const bool too_long =
      transport == Transport::kOpenIgtLink && address.device.size() > kLongestOpenIgtLinkName;
  if (address.device.empty() || too_long) {
    throw section.Error("device", fmt::format("found '{}', expected a name of 1 to {} bytes",
                                              address.device, kLongestOpenIgtLinkName));
  }
  return address;
}

}  // namespace

std::optional<Address> ReadAddress(const YamlMap& map, std::vector<YamlMap>& sections) {
  auto openigtlink = Read(map, "openigtlink", Transport::kOpenIgtLink, sections);
  auto udp = Read(map, "udp", Transport::kUdp, sections);
  if (openigtlink && udp) throw map.Error("udp", "found two sources, expected one");
  return openigtlink ? openigtlink : udp;
}

std::string Text(const Address& address) {
  return fmt::format("{} {}:{} {}", address.transport == Transport::kUdp ? "udp" : "openigtlink",
                     address.host, address.port, address.device);
}

}  // namespace flextip::live
