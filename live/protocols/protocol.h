// What a protocol is to a session. All protocols are listed in protocols.cpp, and nowhere else.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "live/wire.h"
#include "recording/text/yaml_map.h"

namespace flextip::live {

struct Protocol;

/// What the messages of an address carry. kJoints: numbers, a joint each, and after them the
/// efforts of as many where they are there.
enum class Content : std::uint8_t {
  kPose,
  kTip,
  kMoments,
  kForce,
  kPicture,
  kState,
  kText,
  kJoints
};

/// Where messages come from or go to. What host and port are is the protocol's: with UDP the
/// address that is listened on, with ROS 2 the network interface and the domain.
struct Address {
  const Protocol* protocol = nullptr;
  std::string host = "127.0.0.1";
  int port = 0;
  std::string device;  ///< the message's name; with UDP the key of the JSON object
  std::string type;    ///< of the message; empty: the usual one for the content
  Content content = Content::kPose;

  bool SamePeer(const Address& other) const {
    return protocol == other.protocol && host == other.host && port == other.port;
  }
};

/// An open connection to a peer. The destructor ends its calls.
class PeerConnection {
 public:
  virtual ~PeerConnection() = default;
  /// Gives the message to the system; never waits. Returns false where the peer is not there.
  virtual bool Send(const WireMessage& message) = 0;

 protected:
  PeerConnection() = default;
  PeerConnection(const PeerConnection&) = default;
  PeerConnection& operator=(const PeerConnection&) = default;
};

/// What is wanted of a peer: addresses of one SamePeer.
struct PeerWish {
  std::vector<Address> in, out;
  /// Indices of the devices by which both sides wait for one another: the peer's message (of `in`)
  /// and the answer (of `out`) must each come after all that was sent before. -1: none must.
  int lockstep = -1, answer = -1;
  /// Called from a thread of the connection, one call at a time.
  std::function<void(WireMessage&&)> message;
  std::function<void(WireEvent&&)> event;
};

struct Protocol {
  const char* key;  ///< in session files: `wrist0: {KEY: {...}}`
  /// Reads the address from the mapping behind the key; `content` is set. Throws InputError.
  void (*read)(const YamlMap& section, Address& address);
  bool (*carries)(Content content);  ///< from the peer
  bool takes_commands;               ///< whether Send can
  /// Throws WorkError where this build lacks the protocol, or the system refuses it.
  std::unique_ptr<PeerConnection> (*open)(const PeerWish& wish);
};

/// Returns every protocol, the most usual first.
std::span<const Protocol* const> Protocols();

/// Returns their keys, as in "openigtlink, ros2 or udp".
std::string ProtocolKeys();

/// Reads `host` (if there), `port` and `device`, a name of 1 to `longest_device` bytes.
void ReadHostPortDevice(const YamlMap& section, std::size_t longest_device, Address& address);

}  // namespace flextip::live
