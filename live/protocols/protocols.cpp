#include <fmt/format.h>

#include <array>

#include "live/protocols/protocol.h"

namespace flextip::live {

// Each is defined in the folder of its name, in protocol.cpp. A new protocol gets two lines here.
extern const Protocol kOpenIgtLinkProtocol;
extern const Protocol kRos2Protocol;
extern const Protocol kUdpProtocol;

std::span<const Protocol* const> Protocols() {
  static const std::array<const Protocol*, 3> all{
      &kOpenIgtLinkProtocol,
      &kRos2Protocol,
      &kUdpProtocol,
  };
  return all;
}

std::string ProtocolKeys() {
  std::string keys;
  const auto all = Protocols();
  for (std::size_t i = 0; i < all.size(); ++i) {
    keys += i == 0 ? "" : i + 1 == all.size() ? " or " : ", ";
    keys += all[i]->key;
  }
  return keys;
}

void ReadHostPortDevice(const YamlMap& section, std::size_t longest_device, Address& address) {
  constexpr std::int64_t kLastPort = 65535;
  address.host = section.TextOr("host", address.host);
  const std::int64_t port = section.Integer("port");
  if (port < 1 || port > kLastPort)
    throw section.Error("port", fmt::format("found {}, expected 1 to {}", port, kLastPort));
  address.port = static_cast<int>(port);
  address.device = section.Text("device");
  if (address.device.empty() || address.device.size() > longest_device) {
    throw section.Error("device", fmt::format("found '{}', expected a name of 1 to {} bytes",
                                              address.device, longest_device));
  }
}

}  // namespace flextip::live
