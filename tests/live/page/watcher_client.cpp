#include "tests/live/page/watcher_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdlib>

namespace flextip {
namespace {

int Connect(int port) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return socket;
  ::close(socket);
  return -1;
}

void SendAll(int socket, const std::string& bytes) {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t n = ::send(socket, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (n <= 0) return;
    sent += static_cast<std::size_t>(n);
  }
}

/// Appends what comes within `wait_s`; false at the end or where nothing does.
bool ReadMore(int socket, double wait_s, std::string& to) {
  pollfd waited{socket, POLLIN, 0};
  if (::poll(&waited, 1, static_cast<int>(1e3 * wait_s)) <= 0) return false;
  char part[65536];
  const ssize_t n = ::recv(socket, part, sizeof part, 0);
  if (n <= 0) return false;
  to.append(part, static_cast<std::size_t>(n));
  return true;
}

std::string Request(const std::string& method, const std::string& path,
                    const std::string& headers) {
  return method + " " + path + " HTTP/1.1\r\n" + headers + "\r\n";
}

}  // namespace

std::string HostOf(int port) { return "Host: 127.0.0.1:" + std::to_string(port) + "\r\n"; }

std::string Ask(int port, const std::string& path, const std::string& headers,
                const std::string& method) {
  const int socket = Connect(port);
  if (socket < 0) return "";
  SendAll(socket, Request(method, path, headers));
  std::string answer;
  while (ReadMore(socket, 10.0, answer)) {
  }
  ::close(socket);
  return answer;
}

int WatcherClient::Frame::CloseCode() const {
  if (opcode != 8 || payload.size() < 2) return 0;
  return static_cast<unsigned char>(payload[0]) << 8 | static_cast<unsigned char>(payload[1]);
}

WatcherClient::WatcherClient(int port, const std::string& headers) : socket_(Connect(port)) {
  SendBytes(Request("GET", "/live",
                    headers + "Upgrade: websocket\r\nConnection: Upgrade\r\n"
                              "Sec-WebSocket-Version: 13\r\n"
                              "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"));
  std::size_t end = std::string::npos;
  while ((end = buffer_.find("\r\n\r\n")) == std::string::npos)
    if (!ReadMore(socket_, 10.0, buffer_)) return;
  status_ = std::atoi(buffer_.c_str() + buffer_.find(' '));
  buffer_.erase(0, end + 4);
}

WatcherClient::~WatcherClient() {
  if (socket_ >= 0) ::close(socket_);
}

void WatcherClient::SendBytes(const std::string& bytes) { SendAll(socket_, bytes); }

void WatcherClient::Send(std::string_view text, int opcode) {
  std::string frame(1, static_cast<char>(0x80 | opcode));
  if (text.size() < 126) {
    frame += static_cast<char>(0x80 | text.size());
  } else {
    frame += static_cast<char>(0x80 | 126);
    frame += static_cast<char>(text.size() >> 8);
    frame += static_cast<char>(text.size() & 0xff);
  }
  frame.append(4, '\0');  // a mask that changes nothing
  frame += text;
  SendBytes(frame);
}

bool WatcherClient::Fill(std::size_t bytes, double wait_s) {
  while (buffer_.size() < bytes)
    if (!ReadMore(socket_, wait_s, buffer_)) return false;
  return true;
}

std::optional<WatcherClient::Frame> WatcherClient::Receive(double wait_s) {
  if (!Fill(2, wait_s)) return {};
  std::size_t head = 2, length = static_cast<unsigned char>(buffer_[1]) & 0x7f;
  const std::size_t more = length == 126 ? 2 : length == 127 ? 8 : 0;
  if (!Fill(head + more, wait_s)) return {};
  if (more > 0) length = 0;
  for (std::size_t i = 0; i < more; ++i)
    length = length << 8 | static_cast<unsigned char>(buffer_[head + i]);
  head += more;
  if (!Fill(head + length, wait_s)) return {};
  Frame frame{buffer_[0] & 0x0f, buffer_.substr(head, length)};
  buffer_.erase(0, head + length);
  return frame;
}

}  // namespace flextip
