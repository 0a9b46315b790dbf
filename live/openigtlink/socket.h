// TCP sockets that never block. Private to the client and the server.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <string>
#include <utility>

namespace flextip::live {

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  ~Descriptor();
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept;
  bool IsOpen() const { return fd_ >= 0; }
  int get() const { return fd_; }

 private:
  int fd_;
};

/// Wakes a thread that polls, for good or for once.
class Wake {
 public:
  Wake();
  int fd() const { return fd_.get(); }
  void Ring();
  void Clear();
  /// Waits until rung or `wait` has passed.
  void WaitFor(std::chrono::milliseconds wait) const;

 private:
  Descriptor fd_;
};

/// Returns a connection, or a closed descriptor and the reason in `why`. Gives up after `patience`
/// or when `wake` rings.
Descriptor ConnectTcp(const std::string& host, int port, std::chrono::milliseconds patience,
                      const Wake& wake, std::string& why);

/// Returns a listening socket, of 127.0.0.1 or of every address; a closed one and the reason in
/// `why`.
Descriptor ListenTcp(int port, bool any_address, std::string& why);
int PortOf(const Descriptor& socket);

/// Returns the next waiting connection and its "ADDRESS:PORT", closed where there is none.
Descriptor AcceptTcp(const Descriptor& listening, std::string& peer);

}  // namespace flextip::live
