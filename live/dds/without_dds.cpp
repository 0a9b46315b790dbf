// In the place of node.cpp where there is no Cyclone DDS.
#include "core/error.h"
#include "live/dds/node.h"

namespace flextip::live {

class Ros2Node::Worker {};

bool HasRos2() { return false; }

Ros2Node::Ros2Node(Ros2Setup, std::function<void(WireMessage&&)>,
                   std::function<void(WireEvent&&)>) {
  throw WorkError(
      "this program was built without ROS 2 (Debian's cyclonedds-dev and cyclonedds-tools)");
}
Ros2Node::~Ros2Node() = default;
bool Ros2Node::Send(const WireMessage&) { return false; }
bool Ros2Node::IsThere(const std::string&) const { return false; }
bool Ros2Node::HasCommander() const { return false; }
bool Ros2Node::WaitForReaders(std::chrono::milliseconds) const { return true; }
WireCounts Ros2Node::Counts() const { return {}; }

}  // namespace flextip::live
