#include "live/udp/listener.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <thread>

#include "core/error.h"

namespace flextip::live {
namespace {

constexpr std::size_t kMostBytes = 16384;  // of a datagram; longer ones are refused
constexpr int kPoll_ms = 50;

int Bound(const std::string& host, int port) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  const bool known =
      inet_pton(AF_INET, host == "localhost" ? "127.0.0.1" : host.c_str(), &address.sin_addr) == 1;
  if (descriptor >= 0 && known &&
      bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    return descriptor;
  }
  const std::string why =
      known ? std::generic_category().message(errno) : "expected an IPv4 address";
  if (descriptor >= 0) close(descriptor);
  throw WorkError(fmt::format("udp {}:{}: {}", host, port, why));
}

}  // namespace

class UdpListener::Worker {
 public:
  Worker(const std::string& host, int port, std::function<void(WireMessage&&)> message,
         std::function<void(WireEvent&&)> event)
      : name_(fmt::format("udp {}:{}", host, port)),
        message_(std::move(message)),
        event_(std::move(event)),
        descriptor_(Bound(host, port)),
        thread_([this](const std::stop_token& stop) { Run(stop); }) {}
  ~Worker() {
    thread_.request_stop();
    thread_.join();
    close(descriptor_);
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

 private:
  void Run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      pollfd wait{descriptor_, POLLIN, 0};
      if (poll(&wait, 1, kPoll_ms) > 0) Receive();
    }
  }

  void Receive() {
    const ssize_t size = recv(descriptor_, bytes_.data(), bytes_.size(), 0);
    if (size < 0) return;
    if (!connected_) event_({WireEvent::Kind::kConnected, name_ + ": first datagram"});
    connected_ = true;
    std::string problem = fmt::format("more than {} bytes", kMostBytes);
    std::vector<WireMessage> messages;
    if (static_cast<std::size_t>(size) <= kMostBytes) {
      messages = PosesInJson({bytes_.data(), static_cast<std::size_t>(size)}, problem);
    }
    if (!problem.empty()) {
      // One event for a run of them.
      if (!refusing_) event_({WireEvent::Kind::kRefused, name_ + ": " + problem});
      refusing_ = true;
      return;
    }
    refusing_ = false;
    for (WireMessage& message : messages) message_(std::move(message));
  }

  std::string name_;
  std::function<void(WireMessage&&)> message_;
  std::function<void(WireEvent&&)> event_;
  int descriptor_;
  std::array<char, kMostBytes + 1> bytes_{};
  bool connected_ = false, refusing_ = false;
  std::jthread thread_;
};

UdpListener::UdpListener(const std::string& host, int port,
                         std::function<void(WireMessage&&)> message,
                         std::function<void(WireEvent&&)> event)
    : worker_(std::make_unique<Worker>(host, port, std::move(message), std::move(event))) {}

UdpListener::~UdpListener() = default;

}  // namespace flextip::live
