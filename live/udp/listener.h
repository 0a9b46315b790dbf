// UDP datagrams of JSON, as dVRK's socket streamer sends them.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "live/wire.h"

namespace flextip::live {

/// Returns the poses in a datagram, `{"measured_cp": {"Position": {"Translation": [3], "Rotation":
/// [9]}, "Timestamp": s, "Valid": true}}`: one for each key of that form (its device), metres.
/// Rotation: nine numbers row by row, or three rows. What is not valid has time 0. `problem` says
/// why a datagram has none.
std::vector<WireMessage> PosesInJson(std::string_view datagram, std::string& problem);

/// Listens on a port, on a thread of its own. One address is heard at a time: the first that sends
/// a pose, until it has sent none for a second. Poses of a device come in increasing time, as those
/// of OpenIgtLinkClient.
class UdpListener {
 public:
  /// `host`: the address that is listened on. Calls come from the thread: kConnected with the first
  /// pose, kLost after a second without any, kRefused for what is not taken, with its sender.
  /// Throws WorkError where the port cannot be had.
  UdpListener(const std::string& host, int port, std::function<void(WireMessage&&)> message,
              std::function<void(WireEvent&&)> event);
  ~UdpListener();
  UdpListener(const UdpListener&) = delete;
  UdpListener& operator=(const UdpListener&) = delete;

  /// Returns the counts since the start; of datagrams, those refused.
  WireCounts Counts() const;

 private:
  class Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace flextip::live
