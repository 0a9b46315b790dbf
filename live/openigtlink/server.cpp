#include "live/openigtlink/server.h"

#include <fmt/format.h>
#include <poll.h>

#include <algorithm>
#include <atomic>
#include <list>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "core/error.h"
#include "live/openigtlink/codec.h"
#include "live/openigtlink/connection.h"
#include "live/openigtlink/socket.h"

namespace flextip::live {
namespace {

constexpr std::size_t kMostClients = 16;
constexpr std::size_t kLongestServerQueue = std::size_t{16} << 20;

}  // namespace

class OpenIgtLinkServer::Worker {
 public:
  Worker(int port, bool any_address, Connection::OnMessage message, Connection::OnEvent event)
      : message_(std::move(message)), event_(std::move(event)) {
    std::string why;
    listening_ = ListenTcp(port, any_address, why);
    if (!listening_.IsOpen()) throw WorkError(fmt::format("port {}: cannot listen: {}", port, why));
    thread_ = std::thread([this] { Run(); });
  }

  ~Worker() {
    stop_ = true;
    wake_.Ring();
    thread_.join();
  }

  int Send(const WireMessage& message, bool keep_for_newcomers) {
    std::vector<std::uint8_t> bytes = EncodeOpenIgtLink(message);
    int reached = 0;
    const std::lock_guard lock(mutex_);
    for (Client& client : clients_) reached += SendTo(client, bytes) ? 1 : 0;
    if (keep_for_newcomers) kept_.push_back(std::move(bytes));
    return reached;
  }

  void ForgetKept() {
    const std::lock_guard lock(mutex_);
    kept_.clear();
  }

  int port() const { return PortOf(listening_); }
  int Clients() const {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(clients_.size());
  }
  bool HasCommander() const {
    const std::lock_guard lock(mutex_);
    return std::any_of(clients_.begin(), clients_.end(), [](const Client& c) { return c.spoke; });
  }
  WireCounts Counts() const { return counts_.Get(); }

 private:
  struct Client {
    Client(Descriptor socket, const std::string& peer, SharedCounts& counts)
        : connection(std::move(socket), peer, kLongestServerQueue, counts),
          host(peer.substr(0, peer.rfind(':'))) {}
    Connection connection;
    std::string host;     // the address without the port
    bool spoke = false;   // it sent a message of use
    bool warned = false;  // it was told that it does not command
  };

  bool SendTo(Client& client, const std::vector<std::uint8_t>& bytes) {
    const bool sent = client.connection.Send(bytes);
    if (!sent) counts_.Add(&WireCounts::unsent);
    if (sent && client.connection.HasToWrite()) wake_.Ring();
    return sent;
  }

  void Run() {
    while (!stop_) {
      // Only this thread changes the list: it may read it without the lock.
      std::vector<pollfd> waited = {{wake_.fd(), POLLIN, 0}, {listening_.get(), POLLIN, 0}};
      int patience_ms = -1;
      const auto now = WireClock::now();
      for (const Client& client : clients_) {
        const Connection& connection = client.connection;
        const short wanted = static_cast<short>(POLLIN | (connection.HasToWrite() ? POLLOUT : 0));
        waited.push_back({connection.fd(), wanted, 0});
        if (const auto left = connection.TimeLeft(now)) {
          const int left_ms = static_cast<int>(left->count());
          patience_ms = patience_ms < 0 ? left_ms : std::min(patience_ms, left_ms);
        }
      }
      ::poll(waited.data(), waited.size(), patience_ms);
      if (stop_) return;
      if (waited[0].revents != 0) wake_.Clear();
      Attend(waited);
      if (waited[1].revents != 0) Accept();
    }
  }

  void Attend(const std::vector<pollfd>& waited) {
    std::size_t at = 2;
    for (auto client = clients_.begin(); client != clients_.end(); ++at) {
      const auto next = std::next(client);
      if (!Turn(*client, waited[at].revents)) Leave(client);
      client = next;
    }
  }

  bool Turn(Client& client, short ready) {
    Connection& connection = client.connection;
    if ((ready & POLLOUT) != 0 && !connection.Write()) return false;
    const auto take = [&](WireMessage&& message) { Take(client, std::move(message)); };
    if ((ready & ~POLLOUT) != 0 && !connection.Read(take, event_)) return false;
    return connection.IsOnTime(WireClock::now());
  }

  /// Gives a message on, where no other address commands.
  void Take(Client& client, WireMessage&& message) {
    const auto commander =
        std::find_if(clients_.begin(), clients_.end(), [](const Client& c) { return c.spoke; });
    if (commander == clients_.end() || commander->host == client.host) {
      if (!client.spoke) {
        const std::lock_guard lock(mutex_);
        client.spoke = true;
      }
      message_(std::move(message));
      return;
    }
    counts_.Add(&WireCounts::passed, -1);
    counts_.Add(&WireCounts::refused);
    if (std::exchange(client.warned, true)) return;
    event_({WireEvent::Kind::kRefused,
            fmt::format("{}: {}: not taken while {} commands", client.connection.peer(),
                        message.device, commander->host)});
  }

  void Leave(std::list<Client>::iterator client) {
    const std::string why = client->connection.Why();
    {
      const std::lock_guard lock(mutex_);
      clients_.erase(client);
    }
    event_({WireEvent::Kind::kLost, why});
  }

  void Accept() {
    std::string peer;
    Descriptor socket = AcceptTcp(listening_, peer);
    if (!socket.IsOpen()) return;
    if (clients_.size() >= kMostClients) {
      event_({WireEvent::Kind::kRefused,
              fmt::format("{}: refused: there are {} clients", peer, kMostClients)});
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      Client& client = clients_.emplace_back(std::move(socket), peer, counts_);
      for (const auto& bytes : kept_) SendTo(client, bytes);
    }
    event_({WireEvent::Kind::kConnected, fmt::format("{}: connected", peer)});
  }

  Connection::OnMessage message_;
  Connection::OnEvent event_;
  SharedCounts counts_;
  Descriptor listening_;
  Wake wake_;
  std::atomic<bool> stop_ = false;
  mutable std::mutex mutex_;  // of the clients and what is kept, for Send and the questions
  std::list<Client> clients_;
  std::vector<std::vector<std::uint8_t>> kept_;  // for newcomers
  std::thread thread_;
};

OpenIgtLinkServer::OpenIgtLinkServer(int port, bool any_address,
                                     std::function<void(WireMessage&&)> message,
                                     std::function<void(WireEvent&&)> event)
    : worker_(std::make_unique<Worker>(port, any_address, std::move(message), std::move(event))) {}

OpenIgtLinkServer::~OpenIgtLinkServer() = default;

int OpenIgtLinkServer::Send(const WireMessage& message, bool keep_for_newcomers) {
  return worker_->Send(message, keep_for_newcomers);
}
void OpenIgtLinkServer::ForgetKept() { worker_->ForgetKept(); }
int OpenIgtLinkServer::port() const { return worker_->port(); }
int OpenIgtLinkServer::Clients() const { return worker_->Clients(); }
bool OpenIgtLinkServer::HasCommander() const { return worker_->HasCommander(); }
WireCounts OpenIgtLinkServer::Counts() const { return worker_->Counts(); }

}  // namespace flextip::live
