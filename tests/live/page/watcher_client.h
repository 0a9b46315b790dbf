// A client of HTTP and WebSocket by plain sockets, which may also misbehave.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace flextip {

/// Headers of a request, line by line: "Host: 127.0.0.1:80\r\n".
std::string HostOf(int port);

/// Sends `method path` with `headers` to 127.0.0.1 and returns everything that came back.
std::string Ask(int port, const std::string& path, const std::string& headers,
                const std::string& method = "GET");

class WatcherClient {
 public:
  struct Frame {
    int opcode = 0;  ///< 1: text, 2: bytes, 8: close
    std::string payload;

    /// Why the server closes: 1008 a text of no use, 1009 too long.
    int CloseCode() const;
  };

  /// Connects to /live; `headers` beside those of the handshake.
  WatcherClient(int port, const std::string& headers);
  ~WatcherClient();
  WatcherClient(const WatcherClient&) = delete;
  WatcherClient& operator=(const WatcherClient&) = delete;

  /// 101 where the server took it; 0 for no answer.
  int status() const { return status_; }
  void Send(std::string_view text, int opcode = 1);
  /// Sends raw bytes.
  void SendBytes(const std::string& bytes);
  /// Returns the next frame; empty after `wait_s`, or where the connection has ended.
  std::optional<Frame> Receive(double wait_s = 10.0);

 private:
  bool Fill(std::size_t bytes, double wait_s);

  int socket_ = -1, status_ = 0;
  std::string buffer_;
};

}  // namespace flextip
