#include "live/openigtlink/client.h"

#include <fmt/format.h>
#include <poll.h>

#include <atomic>
#include <mutex>
#include <thread>
#include <utility>

#include "core/error.h"
#include "live/openigtlink/codec.h"
#include "live/openigtlink/connection.h"
#include "live/openigtlink/socket.h"

namespace flextip::live {
namespace {

constexpr std::chrono::milliseconds kRetry{200};
constexpr std::chrono::milliseconds kConnectPatience{1000};
constexpr std::size_t kLongestQueue = std::size_t{1} << 20;

}  // namespace

bool HasOpenIgtLink() { return true; }

class OpenIgtLinkClient::Worker {
 public:
  Worker(std::string host, int port, Connection::OnMessage message, Connection::OnEvent event)
      : host_(std::move(host)),
        port_(port),
        name_(fmt::format("{}:{}", host_, port)),
        message_(std::move(message)),
        event_(std::move(event)),
        thread_([this] { Run(); }) {}

  ~Worker() {
    stop_ = true;
    wake_.Ring();
    thread_.join();
  }

  bool Send(const WireMessage& message) {
    const std::vector<std::uint8_t> bytes = EncodeOpenIgtLink(message);
    const std::lock_guard lock(mutex_);
    const bool sent = connection_ != nullptr && connection_->Send(bytes);
    if (!sent) counts_.Add(&WireCounts::unsent);
    if (sent && connection_->HasToWrite()) wake_.Ring();
    return sent;
  }

  WireCounts Counts() const { return counts_.Get(); }

 private:
  void Run() {
    std::string told;  // why there is no connection, once
    while (!stop_) {
      std::string why;
      Descriptor socket = ConnectTcp(host_, port_, kConnectPatience, wake_, why);
      if (socket.IsOpen()) {
        told.clear();
        Attend(std::move(socket));
      } else if (why != told && !stop_) {
        told = why;
        event_({WireEvent::Kind::kLost, fmt::format("{}: cannot connect: {}", name_, why)});
      }
      if (!stop_) wake_.WaitFor(kRetry);
    }
  }

  /// Serves a connection until it is lost.
  void Attend(Descriptor socket) {
    const auto connection =
        std::make_unique<Connection>(std::move(socket), name_, kLongestQueue, counts_);
    Use(connection.get());
    event_({WireEvent::Kind::kConnected, fmt::format("{}: connected", name_)});
    bool alive = true;
    while (alive && !stop_) alive = Turn(*connection);
    Use(nullptr);
    wake_.Clear();  // a Send that rang too late: the next wait is not for it
    if (!stop_) event_({WireEvent::Kind::kLost, connection->Why()});
  }

  bool Turn(Connection& connection) {
    const short wanted = static_cast<short>(POLLIN | (connection.HasToWrite() ? POLLOUT : 0));
    pollfd waited[2] = {{connection.fd(), wanted, 0}, {wake_.fd(), POLLIN, 0}};
    const auto left = connection.TimeLeft(WireClock::now());
    ::poll(waited, 2, left ? static_cast<int>(left->count()) : -1);
    if (waited[1].revents != 0 && !stop_) wake_.Clear();
    if ((waited[0].revents & POLLOUT) != 0 && !connection.Write()) return false;
    const bool readable = (waited[0].revents & ~POLLOUT) != 0;
    if (readable && !connection.Read(message_, event_)) return false;
    return connection.IsOnTime(WireClock::now());
  }

  void Use(Connection* connection) {
    const std::lock_guard lock(mutex_);
    connection_ = connection;
  }

  std::string host_;
  int port_;
  std::string name_;
  Connection::OnMessage message_;
  Connection::OnEvent event_;
  SharedCounts counts_;
  Wake wake_;
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;
  Connection* connection_ = nullptr;
  std::thread thread_;  // last: it uses all others
};

OpenIgtLinkClient::OpenIgtLinkClient(std::string host, int port,
                                     std::function<void(WireMessage&&)> message,
                                     std::function<void(WireEvent&&)> event) {
  constexpr int kLastPort = 65535;
  if (port < 1 || port > kLastPort)
    throw InputError(fmt::format("found the port {}, expected 1 to {}", port, kLastPort));
  worker_ = std::make_unique<Worker>(std::move(host), port, std::move(message), std::move(event));
}

OpenIgtLinkClient::~OpenIgtLinkClient() = default;

bool OpenIgtLinkClient::Send(const WireMessage& message) { return worker_->Send(message); }

WireCounts OpenIgtLinkClient::Counts() const { return worker_->Counts(); }

}  // namespace flextip::live
