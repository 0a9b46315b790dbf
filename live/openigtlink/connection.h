// One open connection: bytes in, messages out of them, bytes to send. Private to the client and the
// server.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "live/openigtlink/socket.h"
#include "live/protocols/reports.h"
#include "live/protocols/stamp_filter.h"
#include "live/wire.h"

namespace flextip::live {

using WireClock = std::chrono::steady_clock;

class Connection {
 public:
  using OnMessage = std::function<void(WireMessage&&)>;
  using OnEvent = std::function<void(WireEvent&&)>;

  /// `longest_queue` is the most bytes that wait to be sent (one message may be longer).
  Connection(Descriptor socket, std::string peer, std::size_t longest_queue, SharedCounts& counts);

  int fd() const { return socket_.get(); }
  const std::string& peer() const { return peer_; }

  /// Reads what is there and gives the messages on. Returns false where the connection is lost;
  /// Why() says how.
  bool Read(const OnMessage& message, const OnEvent& event);
  /// Sends what waits. Returns false where the connection is lost.
  bool Write();
  bool HasToWrite() const;
  /// Returns false where a message has not become whole for 2 s.
  bool IsOnTime(WireClock::time_point now);
  /// Returns the time left for the message under way; empty: none is.
  std::optional<std::chrono::milliseconds> TimeLeft(WireClock::time_point now) const;
  const std::string& Why() const { return why_; }

  /// Sends now what the system takes, and queues the rest. Returns false where the queue is full.
  /// Any thread may call it.
  bool Send(const std::vector<std::uint8_t>& bytes);

 private:
  bool Decode(const OnMessage& message, const OnEvent& event);
  void Pass(WireMessage&& message, const OnMessage& on_message, const OnEvent& event);
  void Drop(const WireMessage& message, StampVerdict verdict, const OnEvent& event);
  bool WriteLocked();

  Descriptor socket_;
  std::string peer_;
  std::size_t longest_queue_;
  SharedCounts& counts_;
  StampFilter filter_;
  std::unique_ptr<std::uint8_t[]> chunk_;  // as received
  std::vector<std::uint8_t> in_;
  std::optional<WireClock::time_point> begun_;  // the message under way
  std::string why_;
  Reports reports_;

  mutable std::mutex out_mutex_;
  std::vector<std::uint8_t> out_;
  bool broken_ = false;
};

}  // namespace flextip::live
