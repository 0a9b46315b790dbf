#include "live/openigtlink/connection.h"

#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>
#include <utility>

#include "live/openigtlink/codec.h"

namespace flextip::live {
namespace {

constexpr std::size_t kChunk = std::size_t{64} << 10;
constexpr int kChunksAtOnce = 16;
constexpr std::chrono::milliseconds kMessagePatience{2000};

}  // namespace

Connection::Connection(Descriptor socket, std::string peer, std::size_t longest_queue,
                       SharedCounts& counts)
    : socket_(std::move(socket)),
      peer_(std::move(peer)),
      longest_queue_(longest_queue),
      counts_(counts),
      chunk_(std::make_unique_for_overwrite<std::uint8_t[]>(kChunk)) {}

bool Connection::Read(const OnMessage& message, const OnEvent& event) {
  for (int chunk = 0; chunk < kChunksAtOnce; ++chunk) {
    const ssize_t got = ::recv(socket_.get(), chunk_.get(), kChunk, 0);
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return true;
    if (got <= 0) {
      why_ = fmt::format("{}: {}{}", peer_, got == 0 ? "closed" : std::strerror(errno),
                         in_.empty() ? "" : " in mid-message");
      return false;
    }
    in_.insert(in_.end(), chunk_.get(), chunk_.get() + got);
    if (!Decode(message, event)) return false;
  }
  return true;
}

bool Connection::Decode(const OnMessage& message, const OnEvent& event) {
  std::size_t at = 0;
  while (at < in_.size()) {
    Decoded decoded = DecodeOpenIgtLink(std::span(in_).subspan(at), peer_);
    if (decoded.status == DecodeStatus::kBroken) {
      counts_.Add(&WireCounts::refused);
      why_ = std::move(decoded.why);
      return false;
    }
    if (decoded.status == DecodeStatus::kMore) break;
    at += decoded.used;
    if (decoded.status == DecodeStatus::kIgnored) counts_.Add(&WireCounts::ignored);
    if (decoded.status == DecodeStatus::kRefused) {
      counts_.Add(&WireCounts::refused);
      reports_.Tell(event, decoded.why);
    }
    for (WireMessage& one : decoded.messages) Pass(std::move(one), message, event);
  }
  if (at > 0) {
    in_.erase(in_.begin(), in_.begin() + static_cast<std::ptrdiff_t>(at));
    begun_.reset();
  }
  if (in_.empty()) {
    begun_.reset();
    if (in_.capacity() > kLongestBody) in_.shrink_to_fit();
  } else if (!begun_) {
    begun_ = WireClock::now();
  }
  return true;
}

void Connection::Pass(WireMessage&& message, const OnMessage& on_message, const OnEvent& event) {
  const StampVerdict verdict = filter_.Judge(message);
  if (verdict != StampVerdict::kPass) {
    Drop(message, verdict, event);
    return;
  }
  counts_.Add(&WireCounts::passed);
  on_message(std::move(message));
}

void Connection::Drop(const WireMessage& message, StampVerdict verdict, const OnEvent& event) {
  if (verdict == StampVerdict::kTooManyDevices) {
    counts_.Add(&WireCounts::refused);
    reports_.Tell(event, fmt::format("{}: names more devices than can be", peer_));
    return;
  }
  const bool repeated = verdict == StampVerdict::kRepeated;
  counts_.Add(repeated ? &WireCounts::repeated : &WireCounts::out_of_order);
  reports_.Tell(event,
                fmt::format("{}: {}: found the time {} after {}, expected a later one", peer_,
                            message.device, message.t_ns, filter_.Last(message.device)));
}

bool Connection::IsOnTime(WireClock::time_point now) {
  if (!begun_ || now - *begun_ < kMessagePatience) return true;
  why_ = fmt::format("{}: stopped in mid-message, after {} bytes of it", peer_, in_.size());
  return false;
}

std::optional<std::chrono::milliseconds> Connection::TimeLeft(WireClock::time_point now) const {
  if (!begun_) return {};
  const auto left = *begun_ + kMessagePatience - now;
  return std::max(std::chrono::ceil<std::chrono::milliseconds>(left), std::chrono::milliseconds(0));
}

bool Connection::Send(const std::vector<std::uint8_t>& bytes) {
  const std::lock_guard lock(out_mutex_);
  if (broken_ || (!out_.empty() && out_.size() + bytes.size() > longest_queue_)) return false;
  out_.insert(out_.end(), bytes.begin(), bytes.end());
  return WriteLocked();
}

bool Connection::Write() {
  const std::lock_guard lock(out_mutex_);
  if (!WriteLocked()) why_ = fmt::format("{}: {}", peer_, "closed");
  return !broken_;
}

bool Connection::HasToWrite() const {
  const std::lock_guard lock(out_mutex_);
  return !out_.empty();
}

bool Connection::WriteLocked() {
  std::size_t sent = 0;
  while (sent < out_.size()) {
    const ssize_t n =
        ::send(socket_.get(), out_.data() + sent, out_.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n < 0) {
      broken_ = errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR;
      break;
    }
    sent += static_cast<std::size_t>(n);
  }
  out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(sent));
  return !broken_;
}

}  // namespace flextip::live
