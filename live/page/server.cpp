#include "live/page/server.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <map>
#include <thread>
#include <utility>
#include <vector>
#include <websocketpp/config/asio_no_tls.hpp>
#include <websocketpp/server.hpp>

#include "core/error.h"
#include "live/page/watcher_texts.h"

namespace flextip::live {
namespace {

namespace ws = websocketpp;
using Endpoint = ws::server<ws::config::asio>;
using Connection = Endpoint::connection_ptr;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kLongestMessage = 512;  // of a watcher, bytes
constexpr std::size_t kMostWatchers = 8, kMostConnections = 64;
constexpr long kOnTheWay = 3;  // sent, and the watcher has not said that it saw them
constexpr std::size_t kMostWaiting = 1 << 15;  // bytes of a watcher, not yet with the system
constexpr long kHandshake_ms = 5000;
constexpr std::chrono::seconds kSilence(10);  // of a watcher that was sent something
constexpr int kNice = 10;                     // the page gives way to everything else
constexpr int kSendBuffer_bytes = 1 << 18;

/// What this page may load and who may show it: nothing but its own files, and nobody.
constexpr const char* kContentPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

struct Watcher {
  long sent = 0, seen = 0;  // numbers of texts and of bytes
  long on_the_way = 0;
  Clock::time_point heard = Clock::now();
};

}  // namespace

bool HasPage() { return true; }

class PageServer::Worker {
 public:
  Worker(int port, std::vector<ServedFile> files, ServerHandlers handlers, double rate_hz)
      : files_(std::move(files)),
        handlers_(std::move(handlers)),
        period_ms_(std::max(1L, std::lround(1000.0 / rate_hz))) {
    endpoint_.clear_access_channels(ws::log::alevel::all);
    endpoint_.clear_error_channels(ws::log::elevel::all);
    endpoint_.init_asio();
    endpoint_.set_reuse_addr(true);
    endpoint_.set_max_message_size(kLongestMessage);
    endpoint_.set_max_http_body_size(0);
    endpoint_.set_open_handshake_timeout(kHandshake_ms);
    endpoint_.set_tcp_pre_init_handler([this](const ws::connection_hdl& to) { Greet(to); });
    endpoint_.set_http_handler([this](const ws::connection_hdl& to) { ServeFile(to); });
    endpoint_.set_validate_handler(
        [this](const ws::connection_hdl& from) { return IsWelcome(from); });
    endpoint_.set_open_handler([this](const ws::connection_hdl& to) { Begin(to); });
    endpoint_.set_close_handler([this](const ws::connection_hdl& from) { watchers_.erase(from); });
    endpoint_.set_message_handler(
        [this](const ws::connection_hdl& from, const Endpoint::message_ptr& message) {
          Hear(from, *message);
        });
    Listen(port);
    thread_ = std::thread([this] { Run(); });
  }

  ~Worker() {
    endpoint_.get_io_service().post([this] { SayGoodbye(); });
    thread_.join();
  }

  int port() const { return port_; }
  int Watchers() const { return static_cast<int>(watchers_.size()); }

  void Send(long n, const std::string& payload, ws::frame::opcode::value kind) {
    std::vector<ws::connection_hdl> silent;
    for (auto& [to, watcher] : watchers_) {
      const Connection connection = endpoint_.get_con_from_hdl(to);
      if (Clock::now() - watcher.heard > kSilence && watcher.on_the_way > 0) silent.push_back(to);
      if (watcher.on_the_way >= kOnTheWay || connection->get_buffered_amount() > kMostWaiting)
        continue;
      if (connection->send(payload, kind)) continue;  // it is going
      watcher.sent = n;
      ++watcher.on_the_way;
    }
    for (const auto& to : silent) Dismiss(to, ws::close::status::policy_violation, "silent");
  }

 private:
  void Listen(int port) {
    using ws::lib::asio::ip::address_v4;
    using ws::lib::asio::ip::tcp;
    ws::lib::error_code error;
    endpoint_.listen(tcp::endpoint(address_v4::loopback(), static_cast<std::uint16_t>(port)),
                     error);
    if (!error) endpoint_.start_accept(error);
    ws::lib::asio::error_code why;
    if (!error) port_ = endpoint_.get_local_endpoint(why).port();
    if (error || why) {
      throw WorkError(
          fmt::format("--page: port {} of 127.0.0.1 cannot be opened: is it taken?", port));
    }
  }

  void Run() {
    setpriority(PRIO_PROCESS, 0, kNice);  // of this thread alone, on Linux
    SetTimer();
    for (bool runs = true; runs;) {
      try {
        endpoint_.run();
        runs = false;
      } catch (const std::exception& fault) {  // it must not end the run of a robot
        handlers_.fault(fault.what());
      }
    }
  }

  void SetTimer() {
    endpoint_.set_timer(period_ms_, [this](const ws::lib::error_code& error) {
      if (error || ends_) return;
      SetTimer();
      handlers_.tick();
    });
  }

  void SayGoodbye() {
    ends_ = true;
    ws::lib::error_code ignored;
    endpoint_.stop_listening(ignored);
    while (!watchers_.empty()) {
      const ws::connection_hdl to = watchers_.begin()->first;
      Dismiss(to, ws::close::status::going_away, "the run is over");
    }
    endpoint_.set_timer(200, [this](const ws::lib::error_code&) { endpoint_.stop(); });
  }

  /// Before a byte is read.
  void Greet(const ws::connection_hdl& to) {
    connections_.erase(std::remove_if(connections_.begin(), connections_.end(),
                                      [](const auto& one) { return one.expired(); }),
                       connections_.end());
    connections_.push_back(to);
    auto& socket = endpoint_.get_con_from_hdl(to)->get_raw_socket();
    ws::lib::asio::error_code ignored;
    if (connections_.size() > kMostConnections) {
      socket.close(ignored);
      return;
    }
    socket.set_option(ws::lib::asio::ip::tcp::no_delay(true), ignored);
    socket.set_option(ws::lib::asio::socket_base::send_buffer_size(kSendBuffer_bytes), ignored);
  }

  bool MayAsk(Endpoint::connection_type& connection) const {
    return IsFromHere(connection.get_request_header("Host"),
                      connection.get_request_header("Origin"), port_);
  }

  void ServeFile(const ws::connection_hdl& to) {
    const Connection connection = endpoint_.get_con_from_hdl(to);
    const auto answer = [&](ws::http::status_code::value status, std::string_view type,
                            std::string_view body) {
      connection->set_status(status);
      connection->replace_header("Content-Type", std::string(type));
      connection->replace_header("Content-Security-Policy", kContentPolicy);
      connection->replace_header("X-Content-Type-Options", "nosniff");
      connection->replace_header("X-Frame-Options", "DENY");
      connection->replace_header("Referrer-Policy", "no-referrer");
      connection->replace_header("Cross-Origin-Resource-Policy", "same-origin");
      connection->replace_header("Cache-Control", "no-store");
      connection->replace_header("Server", "flextip");
      connection->set_body(std::string(body));
    };
    constexpr const char* text = "text/plain; charset=utf-8";
    if (!MayAsk(*connection))
      return answer(ws::http::status_code::forbidden, text, "only this machine's own page\n");
    if (connection->get_request().get_method() != "GET")
      return answer(ws::http::status_code::method_not_allowed, text, "GET only\n");
    std::string path = connection->get_resource();
    path = path.substr(0, path.find('?'));
    if (path == "/") path = "/index.html";
    for (const ServedFile& file : files_)
      if (file.path == path) return answer(ws::http::status_code::ok, file.type, file.text);
    answer(ws::http::status_code::not_found, text, "no such file\n");
  }

  bool IsWelcome(const ws::connection_hdl& from) {
    const Connection connection = endpoint_.get_con_from_hdl(from);
    if (!MayAsk(*connection)) {
      connection->set_status(ws::http::status_code::forbidden);
    } else if (connection->get_resource() != "/live") {
      connection->set_status(ws::http::status_code::not_found);
    } else if (ends_ || watchers_.size() >= kMostWatchers) {
      connection->set_status(ws::http::status_code::service_unavailable);
    } else {
      return true;
    }
    return false;
  }

  void Begin(const ws::connection_hdl& to) {
    if (ends_ || watchers_.size() >= kMostWatchers)
      return Dismiss(to, ws::close::status::try_again_later, "too many watchers");
    watchers_[to] = {};
    endpoint_.get_con_from_hdl(to)->send(handlers_.hello(), ws::frame::opcode::text);
  }

  void Hear(const ws::connection_hdl& from, const Endpoint::message_ptr::element_type& message) {
    const auto found = watchers_.find(from);
    if (found == watchers_.end()) return;
    Watcher& watcher = found->second;
    watcher.heard = Clock::now();
    std::optional<std::string> answer;
    if (message.get_opcode() == ws::frame::opcode::text) {
      const std::string& text = message.get_payload();
      if (const auto seen = ReadSeen(text)) {
        if (*seen > watcher.sent || *seen <= watcher.seen || watcher.on_the_way == 0)
          return Dismiss(from, ws::close::status::policy_violation, "seen before it was sent");
        watcher.seen = *seen;
        --watcher.on_the_way;
        return;
      }
      answer = handlers_.answer(text);
    }
    if (!answer) return Dismiss(from, ws::close::status::policy_violation, "not understood");
    // Every wish is answered, also while a state is on its way; who asks and never reads, goes.
    const Connection connection = endpoint_.get_con_from_hdl(from);
    if (connection->get_buffered_amount() > kMostWaiting)
      return Dismiss(from, ws::close::status::policy_violation, "answers are not read");
    connection->send(*answer, ws::frame::opcode::text);
  }

  void Dismiss(const ws::connection_hdl& who, ws::close::status::value why, const char* reason) {
    watchers_.erase(who);
    ws::lib::error_code ignored;
    endpoint_.close(who, why, reason, ignored);
  }

  const std::vector<ServedFile> files_;
  const ServerHandlers handlers_;
  const long period_ms_;
  Endpoint endpoint_;
  int port_ = 0;
  bool ends_ = false;
  std::map<ws::connection_hdl, Watcher, std::owner_less<ws::connection_hdl>> watchers_;
  std::vector<ws::connection_hdl> connections_;
  std::thread thread_;
};

PageServer::PageServer(int port, std::vector<ServedFile> files, ServerHandlers handlers,
                       double rate_hz)
    : worker_(std::make_unique<Worker>(port, std::move(files), std::move(handlers), rate_hz)) {}
PageServer::~PageServer() = default;
int PageServer::port() const { return worker_->port(); }
int PageServer::Watchers() const { return worker_->Watchers(); }
void PageServer::SendText(long n, const std::string& text) {
  worker_->Send(n, text, ws::frame::opcode::text);
}
void PageServer::SendBytes(long n, const std::string& bytes) {
  worker_->Send(n, bytes, ws::frame::opcode::binary);
}

}  // namespace flextip::live
