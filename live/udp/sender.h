// Poses as UDP datagrams of JSON, in the form of dVRK's socket streamer.
#pragma once

#include <memory>
#include <string>

#include "live/wire.h"

namespace flextip::live {

/// Returns the datagram of a pose, which PosesInJson reads: one key, the device's name behind its
/// last slash; numbers exact, but the time, which is seconds. Throws InputError for other messages
/// and numbers that are not finite.
std::string PoseAsJson(const WireMessage& message);

/// Sends to a port of this machine.
class UdpSender {
 public:
  /// Throws InputError where `port` is none, WorkError where there is no socket.
  explicit UdpSender(int port);
  ~UdpSender();
  UdpSender(const UdpSender&) = delete;
  UdpSender& operator=(const UdpSender&) = delete;

  /// Gives the pose to the system; never waits. Whether somebody listens is not known. Returns
  /// false where the system does not take it.
  bool Send(const WireMessage& message) const;

 private:
  int descriptor_;
};

}  // namespace flextip::live
