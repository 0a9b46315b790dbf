// A participant of ROS 2's graph by DDS: reads topics and writes topics. DDS has no clients and
// servers; control and the virtual robot are both such nodes.
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "live/dds/types.h"
#include "live/wire.h"

namespace flextip::live {

/// A topic by its name in ROS 2, without a slash in front: "PSM1/measured_cp" is
/// rt/PSM1/measured_cp on the wire.
struct Ros2Topic {
  std::string name;
  std::vector<Ros2Type> types;  ///< any of these is read; the first is written
};

struct Ros2Setup {
  int domain = 0;
  std::string network =
      "lo";  ///< interface; "lo" keeps to this machine, empty: the library's choice
  std::vector<Ros2Topic> in, out;
  /// Both sides wait for one another: nothing is left out, however many samples come at once and
  /// also before a reader is there (transient local, where both offer it), and readers are asked
  /// soon what they have.
  bool lockstep = false;
  /// Of `in` and `out`, in lockstep: given after, and sent when readers have, all that was sent
  /// before. The reader of `last_out` counts as there when it is known on all topics that it reads.
  /// -1: none is so.
  int last_in = -1, last_out = -1;
  /// The topic `last_in` is opened when somebody is there for all others, and told what they are.
  bool opens_last_in_late = false;
  bool one_commander = false;  ///< the first participant that sends is listened to until it is gone
  bool says_invalid = true;    ///< an event for a stamp of 0
};

/// Returns whether this build has ROS 2. Without it nodes throw WorkError when they are made.
bool HasRos2();

inline constexpr int kLastDomain = 232;  // later ones have no ports

/// Returns the domain that ROS_DOMAIN_ID names, 0 without it. Throws InputError where that is none.
int RosDomain();

/// Reads on a thread of its own. Quality of service as ROS 2's default: reliable, volatile, the
/// last 10; a reader goes down to best effort where a publisher offers no more. Messages of a topic
/// come in increasing time, as those of OpenIgtLinkClient.
class Ros2Node {
 public:
  /// Starts the thread. `message` and `event` are called from it, one call at a time, until the
  /// destructor returns. Events name their topic as device: kConnected when the first writer (of
  /// `out`: reader) is there, kLost when the last has gone, or none came within a second. Throws
  /// WorkError where the domain cannot be opened, or without ROS 2.
  Ros2Node(Ros2Setup setup, std::function<void(WireMessage&&)> message,
           std::function<void(WireEvent&&)> event);
  ~Ros2Node();
  Ros2Node(const Ros2Node&) = delete;
  Ros2Node& operator=(const Ros2Node&) = delete;

  /// Gives the message to the library; never waits for a reader, but with `last_out` for a second
  /// at most. Returns false where nobody reads the topic or it is none of `out`; in lockstep the
  /// message is kept for a reader to come. Any thread may call it. Throws InputError for a message
  /// that its type cannot carry.
  bool Send(const WireMessage& message);

  /// Returns whether a writer (of `out`: a reader) of the topic is there.
  bool IsThere(const std::string& topic) const;
  /// Returns whether the participant that commanded is there.
  bool HasCommander() const;
  /// Waits until reliable readers have all that was sent. Returns false where they do not in time.
  bool WaitForReaders(std::chrono::milliseconds patience) const;
  /// Returns the counts since the start.
  WireCounts Counts() const;

 private:
  class Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace flextip::live
