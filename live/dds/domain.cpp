#include "live/dds/domain.h"

#include <dds/dds.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>
#include <utility>

#include "core/error.h"

namespace flextip::live {
namespace {

thread_local std::string last_said;

/// Over the table of open domains and their ends; Open may end one itself.
std::recursive_mutex open_mutex;

void Listen(void*, const dds_log_data_t* data) {
  last_said.assign(data->message, data->size);
  while (!last_said.empty() && last_said.back() <= ' ') last_said.pop_back();
}

/// Participants of this machine find one another through the ports of indices up to 32, and by
/// multicast on the loopback interface where it is taken.
constexpr const char* kThisMachine =
    "<General><Interfaces><NetworkInterface name=\"lo\" multicast=\"true\"/></Interfaces></General>"
    "<Discovery><ParticipantIndex>auto</ParticipantIndex>"
    "<MaxAutoParticipantIndex>32</MaxAutoParticipantIndex>"
    "<Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>";

std::string Configuration(const std::string& network, bool quick) {
  std::string text;
  if (network == "lo") {
    text += kThisMachine;
  } else if (!network.empty()) {
    const bool is_address = network.find_first_not_of("0123456789.") == std::string::npos;
    text += fmt::format("<General><Interfaces><NetworkInterface {}=\"{}\"/></Interfaces></General>",
                        is_address ? "address" : "name", network);
  }
  if (quick) {
    text +=
        "<Internal><HeartbeatInterval min=\"1 ms\" minsched=\"1 ms\" max=\"100 ms\">1 ms"
        "</HeartbeatInterval></Internal>";
  }
  return text;
}

void RequireName(const std::string& network) {
  const bool good = std::all_of(network.begin(), network.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
           c == '-' || c == '_' || c == ':';
  });
  if (!good)
    throw InputError(fmt::format("found '{}', expected the name of a network interface", network));
}

}  // namespace

std::string DdsProblem(DdsHandle error) {
  const std::string name = dds_strretcode(-error);
  return last_said.empty() ? name : fmt::format("{} ({})", name, std::exchange(last_said, {}));
}

std::shared_ptr<Ros2Domain> Ros2Domain::Open(int domain, const std::string& network, bool quick) {
  static std::map<int, std::weak_ptr<Ros2Domain>> open;
  const std::lock_guard lock(open_mutex);
  if (auto known = open[domain].lock()) {
    if (known->network_ == network) return known;
    throw WorkError(
        fmt::format("ros2 domain {}: is open on the network interface '{}' already, "
                    "found '{}'",
                    domain, known->network_, network));
  }
  RequireName(network);
  std::shared_ptr<Ros2Domain> made(new Ros2Domain(domain, network, quick));
  open[domain] = made;
  return made;
}

Ros2Domain::Ros2Domain(int domain, std::string network, bool quick)
    : domain_(domain), network_(std::move(network)) {
  dds_set_log_sink(Listen, nullptr);
  if (std::getenv("CYCLONEDDS_URI") != nullptr) return;
  const std::string text = Configuration(network_, quick);
  const dds_entity_t made = dds_create_domain(static_cast<dds_domainid_t>(domain), text.c_str());
  if (made == DDS_RETCODE_PRECONDITION_NOT_MET) return;  // somebody else's
  if (made < 0)
    throw WorkError(fmt::format("ros2 domain {} on '{}': {}", domain, network_, DdsProblem(made)));
  entity_ = made;
}

Ros2Domain::~Ros2Domain() {
  const std::lock_guard lock(open_mutex);
  if (entity_ > 0) dds_delete(entity_);
}

DdsHandle Ros2Domain::NewParticipant() const {
  const dds_entity_t made =
      dds_create_participant(static_cast<dds_domainid_t>(domain_), nullptr, nullptr);
  if (made < 0) {
    throw WorkError(fmt::format("ros2 domain {} on '{}': {}", domain_, network_, DdsProblem(made)));
  }
  return made;
}

}  // namespace flextip::live
