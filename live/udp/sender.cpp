#include "live/udp/sender.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/error.h"

namespace flextip::live {

std::string PoseAsJson(const WireMessage& message) {
  const auto* const transform = std::get_if<WireTransform>(&message.body);
  if (transform == nullptr || !transform->T_RD.Matrix().allFinite())
    throw InputError(fmt::format("{}: expected a pose of finite numbers", message.device));
  const Pose& T_RD = transform->T_RD;
  nlohmann::json rotation = nlohmann::json::array();
  for (int i = 0; i < 9; ++i) rotation.push_back(T_RD.R(i / 3, i % 3));
  const std::string key = message.device.substr(message.device.rfind('/') + 1);
  const nlohmann::json datagram = {
      {key,
       {{"Position",
         {{"Translation", {T_RD.p.x(), T_RD.p.y(), T_RD.p.z()}}, {"Rotation", rotation}}},
        {"Timestamp", 1e-9 * static_cast<double>(message.t_ns)},
        {"Valid", message.t_ns > 0}}}};
  return datagram.dump();
}

UdpSender::UdpSender(int port)
    : descriptor_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
  constexpr int kLastPort = 65535;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool is_port = port >= 1 && port <= kLastPort;
  if (is_port && descriptor_ >= 0 &&
      connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    return;
  }
  const std::string why = std::generic_category().message(errno);
  if (descriptor_ >= 0) close(descriptor_);
  if (!is_port)
    throw InputError(fmt::format("found the port {}, expected 1 to {}", port, kLastPort));
  throw WorkError(fmt::format("udp port {}: {}", port, why));
}

UdpSender::~UdpSender() { close(descriptor_); }

bool UdpSender::Send(const WireMessage& message) const {
  const std::string datagram = PoseAsJson(message);
  // Where nobody listened to the last one, this one is refused in its place: it is sent once more.
  for (int attempt = 0; attempt < 2; ++attempt) {
    const ssize_t sent =
        send(descriptor_, datagram.data(), datagram.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent == static_cast<ssize_t>(datagram.size())) return true;
  }
  return false;
}

}  // namespace flextip::live
