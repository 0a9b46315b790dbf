#include "live/udp/listener.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "core/error.h"
#include "live/protocols/reports.h"
#include "live/protocols/stamp_filter.h"

namespace flextip::live {
namespace {

constexpr std::size_t kMostBytes = 16384;  // of a datagram; longer ones are refused
constexpr int kPoll_ms = 50;
constexpr std::chrono::seconds kSilence{1};

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

  WireCounts Counts() const { return counts_.Get(); }

 private:
  using Clock = std::chrono::steady_clock;

  void Run(const std::stop_token& stop) {
    last_ = Clock::now();
    while (!stop.stop_requested()) {
      pollfd wait{descriptor_, POLLIN, 0};
      if (poll(&wait, 1, kPoll_ms) > 0) Receive();
      if (Clock::now() - last_ > kSilence) NoteSilence();
    }
  }

  void NoteSilence() {
    if (told_silence_) return;
    told_silence_ = true;
    const std::string who = sender_.empty() ? name_ : fmt::format("{} from {}", name_, sender_);
    event_({WireEvent::Kind::kLost, who + ": no pose for a second"});
    sender_.clear();
    filter_.ForgetAll();
  }

  void Receive() {
    sockaddr_in from{};
    socklen_t from_size = sizeof from;
    const ssize_t size = recvfrom(descriptor_, bytes_.data(), bytes_.size(), 0,
                                  reinterpret_cast<sockaddr*>(&from), &from_size);
    if (size < 0) return;
    std::array<char, INET_ADDRSTRLEN> text{};
    const std::string sender = inet_ntop(AF_INET, &from.sin_addr, text.data(), text.size());
    if (!sender_.empty() && sender != sender_) {
      Refuse(sender, fmt::format("not heard while {} sends", sender_));
      return;
    }
    std::string problem = fmt::format("more than {} bytes", kMostBytes);
    std::vector<WireMessage> messages;
    if (static_cast<std::size_t>(size) <= kMostBytes) {
      messages = PosesInJson({bytes_.data(), static_cast<std::size_t>(size)}, problem);
    }
    if (!problem.empty()) {
      Refuse(sender, problem);
      return;
    }
    Hear(sender);
    for (WireMessage& message : messages) Pass(std::move(message));
  }

  void Hear(const std::string& sender) {
    last_ = Clock::now();
    told_silence_ = false;
    if (sender_ == sender) return;
    sender_ = sender;
    event_({WireEvent::Kind::kConnected, fmt::format("{} from {}: sends", name_, sender_)});
  }

  void Pass(WireMessage&& message) {
    const StampVerdict verdict = filter_.Judge(message);
    if (verdict == StampVerdict::kPass) {
      counts_.Add(&WireCounts::passed);
      message_(std::move(message));
      return;
    }
    if (verdict == StampVerdict::kTooManyDevices) {
      Refuse(sender_, "names more devices than can be");
      return;
    }
    counts_.Add(verdict == StampVerdict::kRepeated ? &WireCounts::repeated
                                                   : &WireCounts::out_of_order);
    reports_.Tell(event_, fmt::format("{} from {}: {}: found the time {} after {}, expected a "
                                      "later one",
                                      name_, sender_, Printable(message.device, kShownBytes),
                                      message.t_ns, filter_.Last(message.device)));
  }

  void Refuse(const std::string& sender, const std::string& why) {
    counts_.Add(&WireCounts::refused);
    reports_.Tell(event_, fmt::format("{} from {}: {}", name_, sender, why));
  }

  std::string name_;
  std::function<void(WireMessage&&)> message_;
  std::function<void(WireEvent&&)> event_;
  int descriptor_;
  SharedCounts counts_;
  Reports reports_;
  StampFilter filter_;
  std::array<char, kMostBytes + 1> bytes_{};
  std::string sender_;  // empty: nobody is heard yet, or any more
  Clock::time_point last_;
  bool told_silence_ = false;
  std::jthread thread_;
};

UdpListener::UdpListener(const std::string& host, int port,
                         std::function<void(WireMessage&&)> message,
                         std::function<void(WireEvent&&)> event)
    : worker_(std::make_unique<Worker>(host, port, std::move(message), std::move(event))) {}

UdpListener::~UdpListener() = default;

WireCounts UdpListener::Counts() const { return worker_->Counts(); }

}  // namespace flextip::live
