#include "live/openigtlink/socket.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace flextip::live {
namespace {

void Set(int fd, int level, int option, int value) {
  ::setsockopt(fd, level, option, &value, sizeof value);
}

/// Small messages go at once; a peer whose cable was pulled is lost after some seconds.
void Tune(int fd) {
  Set(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  Set(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  Set(fd, IPPROTO_TCP, TCP_KEEPIDLE, 2);
  Set(fd, IPPROTO_TCP, TCP_KEEPINTVL, 1);
  Set(fd, IPPROTO_TCP, TCP_KEEPCNT, 3);
  Set(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, 5000);
}

/// A connection to a free port of this machine can meet itself.
bool IsToItself(int fd) {
  sockaddr_storage own{}, other{};
  socklen_t own_size = sizeof own, other_size = sizeof other;
  return ::getsockname(fd, reinterpret_cast<sockaddr*>(&own), &own_size) == 0 &&
         ::getpeername(fd, reinterpret_cast<sockaddr*>(&other), &other_size) == 0 &&
         own_size == other_size && std::memcmp(&own, &other, own_size) == 0;
}

Descriptor ConnectTo(const addrinfo& address, std::chrono::milliseconds patience, const Wake& wake,
                     std::string& why) {
  Descriptor socket(::socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!socket.IsOpen()) {
    why = std::strerror(errno);
    return socket;
  }
  if (::connect(socket.get(), address.ai_addr, address.ai_addrlen) != 0) {
    if (errno != EINPROGRESS) {
      why = std::strerror(errno);
      return Descriptor();
    }
    pollfd waited[2] = {{socket.get(), POLLOUT, 0}, {wake.fd(), POLLIN, 0}};
    ::poll(waited, 2, static_cast<int>(patience.count()));
    if (waited[0].revents == 0) {
      why = "no answer";
      return Descriptor();
    }
    int error = 0;
    socklen_t size = sizeof error;
    ::getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size);
    if (error != 0) {
      why = std::strerror(error);
      return Descriptor();
    }
  }
  if (IsToItself(socket.get())) {
    why = std::strerror(ECONNREFUSED);
    return Descriptor();
  }
  Tune(socket.get());
  return socket;
}

}  // namespace

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
  std::swap(fd_, other.fd_);
  return *this;
}

Wake::Wake() : fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {}

void Wake::Ring() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(fd_.get(), &one, sizeof one);
}

void Wake::Clear() {
  std::uint64_t count = 0;
  [[maybe_unused]] const auto read = ::read(fd_.get(), &count, sizeof count);
}

void Wake::WaitFor(std::chrono::milliseconds wait) const {
  pollfd waited{fd_.get(), POLLIN, 0};
  ::poll(&waited, 1, static_cast<int>(wait.count()));
}

Descriptor ConnectTcp(const std::string& host, int port, std::chrono::milliseconds patience,
                      const Wake& wake, std::string& why) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found);
  if (error != 0) {
    why = ::gai_strerror(error);
    return Descriptor();
  }
  Descriptor socket;
  for (const addrinfo* address = found; address != nullptr && !socket.IsOpen();
       address = address->ai_next) {
    socket = ConnectTo(*address, patience, wake, why);
  }
  ::freeaddrinfo(found);
  return socket;
}

Descriptor ListenTcp(int port, bool any_address, std::string& why) {
  Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  Set(socket.get(), SOL_SOCKET, SO_REUSEADDR, 1);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(any_address ? INADDR_ANY : INADDR_LOOPBACK);
  constexpr int kWaiting = 16;
  if (!socket.IsOpen() ||
      ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(socket.get(), kWaiting) != 0) {
    why = std::strerror(errno);
    return Descriptor();
  }
  return socket;
}

int PortOf(const Descriptor& socket) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  ::getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

Descriptor AcceptTcp(const Descriptor& listening, std::string& peer) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  Descriptor socket(::accept4(listening.get(), reinterpret_cast<sockaddr*>(&address), &size,
                              SOCK_NONBLOCK | SOCK_CLOEXEC));
  if (!socket.IsOpen()) return socket;
  Tune(socket.get());
  char text[INET_ADDRSTRLEN] = "";
  ::inet_ntop(AF_INET, &address.sin_addr, text, sizeof text);
  peer = fmt::format("{}:{}", text, ntohs(address.sin_port));
  return socket;
}

}  // namespace flextip::live
