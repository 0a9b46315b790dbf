// ROS 2 in the list of protocols.
#include "live/protocols/protocol.h"

#include <charconv>
#include <cstdlib>
#include <cstring>

#include "core/error.h"
#include "live/dds/node.h"

namespace flextip::live {
namespace {

constexpr std::size_t kLongestTopic = 200;

bool IsTopic(const std::string& name) {
  if (name.empty() || name.size() > kLongestTopic || name.back() == '/') return false;
  bool begins = true;
  for (const char c : name) {
    const bool is_digit = c >= '0' && c <= '9';
    const bool is_letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    if (c == '/' ? begins : !(is_letter || (is_digit && !begins))) return false;
    begins = c == '/';
  }
  return true;
}

void ReadType(const YamlMap& section, Address& address) {
  address.type = section.TextOr("type", "");
  if (address.type.empty()) return;
  std::string known;
  for (const Ros2Type type : Ros2TypesFor(address.content)) {
    if (address.type == Name(type)) return;
    known += (known.empty() ? "" : " or ") + std::string(Name(type));
  }
  throw section.Error("type", fmt::format("found '{}', expected {}", address.type, known));
}

void ReadRos2(const YamlMap& section, Address& address) {
  address.device = section.Text("topic");
  if (address.device.starts_with('/')) address.device.erase(0, 1);
  if (!IsTopic(address.device)) {
    throw section.Error("topic", fmt::format("found '{}', expected a topic of ROS 2: letters, "
                                             "digits, _ and / between words",
                                             address.device));
  }
  address.host = section.TextOr("network", "lo");
  const std::int64_t domain = section.Has("domain") ? section.Integer("domain") : RosDomain();
  if (domain < 0 || domain > kLastDomain)
    throw section.Error("domain", fmt::format("found {}, expected 0 to {}", domain, kLastDomain));
  address.port = static_cast<int>(domain);
  ReadType(section, address);
}

Ros2Topic TopicOf(const Address& address) {
  for (const Ros2Type type : Ros2TypesFor(address.content))
    if (address.type == Name(type)) return {address.device, {type}};
  return {address.device, Ros2TypesFor(address.content)};
}

Ros2Setup SetupOf(const PeerWish& wish) {
  const Address& any = wish.in.empty() ? wish.out.front() : wish.in.front();
  Ros2Setup setup;
  setup.domain = any.port;
  setup.network = any.host;
  setup.lockstep = wish.lockstep >= 0;
  setup.last_in = wish.lockstep;
  setup.opens_last_in_late = true;
  setup.last_out = wish.answer;
  for (const Address& address : wish.in) setup.in.push_back(TopicOf(address));
  for (const Address& address : wish.out) setup.out.push_back(TopicOf(address));
  return setup;
}

class Ros2Peer : public PeerConnection {
 public:
  explicit Ros2Peer(const PeerWish& wish) : node_(SetupOf(wish), wish.message, wish.event) {}
  bool Send(const WireMessage& message) override { return node_.Send(message); }

 private:
  Ros2Node node_;
};

}  // namespace

int RosDomain() {
  const char* const text = std::getenv("ROS_DOMAIN_ID");
  if (text == nullptr || *text == '\0') return 0;
  int domain = -1;
  const char* const end = text + std::strlen(text);
  const auto read = std::from_chars(text, end, domain);
  if (read.ec != std::errc() || read.ptr != end || domain < 0 || domain > kLastDomain) {
    throw InputError(fmt::format("the environment's ROS_DOMAIN_ID: found '{}', expected 0 to {}",
                                 text, kLastDomain));
  }
  return domain;
}

extern const Protocol kRos2Protocol{
    .key = "ros2",
    .read = ReadRos2,
    .carries = [](Content) { return true; },
    .takes_commands = true,
    .open = [](const PeerWish& wish) -> std::unique_ptr<PeerConnection> {
      return std::make_unique<Ros2Peer>(wish);
    },
};

}  // namespace flextip::live
