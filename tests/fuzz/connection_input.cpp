#include "tests/fuzz/connection_input.h"

#include <igtl_header.h>
#include <igtl_util.h>
#include <sys/socket.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "live/openigtlink/codec.h"
#include "live/openigtlink/connection.h"

namespace flextip {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::size_t kLongestQueue = 600;
constexpr std::size_t kMostActs = 200;  // all of them fit into a socket

void Require(bool holds) {
  if (!holds) std::abort();
}

/// Bytes in one piece, from the peer or to it.
struct Act {
  bool from_peer = true;
  Bytes bytes;
};

/// A message of these bytes, its first 58 the header: length and check sum are put right.
Bytes Mended(Bytes bytes) {
  if (bytes.size() < IGTL_HEADER_SIZE) return bytes;
  const std::size_t size = bytes.size() - IGTL_HEADER_SIZE;
  const auto put = [&bytes](std::size_t at, std::uint64_t value) {
    for (std::size_t i = 0; i < 8; ++i)
      bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * (7 - i)));
  };
  put(42, size);
  put(50, size > 0 ? crc64(bytes.data() + IGTL_HEADER_SIZE, size, 0) : 0);
  return bytes;
}

/// A pose whose device and time the first two bytes say.
Bytes PoseMessage(const Bytes& bytes) {
  live::WireMessage pose;
  pose.device = bytes.empty() ? "robot" : std::string(1, static_cast<char>('a' + bytes[0] % 3));
  pose.t_ns = bytes.size() < 2 ? 0 : 1'000'000'000 + TimeNs{bytes[1]} * 10'000'000;
  pose.body = live::WireTransform{};
  return live::EncodeOpenIgtLink(pose);
}

std::vector<Act> ActsIn(std::span<const std::uint8_t> input) {
  std::vector<Act> acts;
  std::size_t at = 0;
  while (at + 2 <= input.size() && acts.size() < kMostActs) {
    const int kind = input[at] % 4;
    const std::size_t size = std::min<std::size_t>(input[at + 1], input.size() - at - 2);
    Bytes bytes(input.begin() + static_cast<std::ptrdiff_t>(at + 2),
                input.begin() + static_cast<std::ptrdiff_t>(at + 2 + size));
    at += 2 + size;
    if (kind == 1) bytes = Mended(std::move(bytes));
    if (kind == 2) bytes = PoseMessage(bytes);
    if (!bytes.empty()) acts.push_back({kind != 3, std::move(bytes)});
  }
  return acts;
}

/// The two ends of a socket: the connection's, and the peer's as a plain descriptor.
class Session {
 public:
  Session() {
    int ends[2];
    Require(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) == 0);
    const int least = 1;  // the system takes its minimum
    Require(::setsockopt(ends[0], SOL_SOCKET, SO_SNDBUF, &least, sizeof least) == 0);
    peer_ = live::Descriptor(ends[1]);
    connection_ = std::make_unique<live::Connection>(live::Descriptor(ends[0]), "127.0.0.1:1",
                                                     kLongestQueue, counts_);
  }

  /// The peer sends a piece, and the connection reads it.
  void Take(std::span<const std::uint8_t> piece) {
    if (!alive_) return;
    Require(::send(peer_.get(), piece.data(), piece.size(), MSG_NOSIGNAL) ==
            static_cast<ssize_t>(piece.size()));
    alive_ = Read();
    const bool under_way = connection_->TimeLeft(live::WireClock::now()).has_value();
    if (alive_) Require(LateSoon() == under_way);
  }

  void Send(const Bytes& bytes) {
    if (!alive_ || !connection_->Send(bytes)) return;
    accepted_.insert(accepted_.end(), bytes.begin(), bytes.end());
  }

  /// The peer reads all, closes, and the connection is lost.
  void End() {
    if (alive_) ReadAsPeer();
    Require(::shutdown(peer_.get(), SHUT_RDWR) == 0);
    if (alive_) Require(!Read());
    Require(!connection_->Why().empty());
    for (const char c : connection_->Why()) Require(c >= ' ');
  }

  const std::vector<live::WireMessage>& messages() const { return messages_; }
  const std::string& why() const { return connection_->Why(); }
  live::WireCounts counts() const { return counts_.Get(); }

 private:
  bool Read() {
    return connection_->Read(
        [this](live::WireMessage&& message) { messages_.push_back(std::move(message)); },
        [](live::WireEvent&& event) {
          for (const char c : event.what) Require(c >= ' ');
        });
  }

  bool LateSoon() const {
    const auto later = live::WireClock::now() + std::chrono::seconds(3);
    return connection_->TimeLeft(later) == std::chrono::milliseconds(0);
  }

  void ReadAsPeer() {
    Bytes seen;
    for (bool more = true; more;) {
      Bytes chunk(4096);
      const ssize_t got = ::recv(peer_.get(), chunk.data(), chunk.size(), 0);
      if (got > 0) seen.insert(seen.end(), chunk.begin(), chunk.begin() + got);
      more = got > 0 || connection_->HasToWrite();
      Require(connection_->Write());
    }
    Require(seen == accepted_);
  }

  live::SharedCounts counts_;
  live::Descriptor peer_;
  std::unique_ptr<live::Connection> connection_;
  bool alive_ = true;
  std::vector<live::WireMessage> messages_;
  Bytes accepted_;
};

void RequireSame(const Session& one, const Session& other) {
  const live::WireCounts a = one.counts(), b = other.counts();
  Require(a.passed == b.passed && a.repeated == b.repeated && a.refused == b.refused);
  Require(a.out_of_order == b.out_of_order && a.ignored == b.ignored);
  Require(one.why() == other.why() && one.messages().size() == other.messages().size());
  Require(a.passed == static_cast<std::int64_t>(one.messages().size()));
  for (std::size_t i = 0; i < one.messages().size(); ++i) {
    const live::WireMessage &m = one.messages()[i], &n = other.messages()[i];
    Require(m.device == n.device && m.t_ns == n.t_ns && m.body.index() == n.body.index());
  }
}

}  // namespace

int CheckConnectionInput(std::span<const std::uint8_t> input) {
  Session in_acts, at_once;
  Bytes all;
  for (const Act& act : ActsIn(input)) {
    if (act.from_peer) {
      in_acts.Take(act.bytes);
      all.insert(all.end(), act.bytes.begin(), act.bytes.end());
    } else {
      in_acts.Send(act.bytes);
    }
  }
  if (!all.empty()) at_once.Take(all);
  in_acts.End();
  at_once.End();
  RequireSame(in_acts, at_once);
  return static_cast<int>(at_once.messages().size());
}

}  // namespace flextip
