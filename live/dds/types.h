// The types of ROS 2's messages that are known here, and what they carry.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "live/protocols/protocol.h"

namespace flextip::live {

enum class Ros2Type : std::uint8_t {
  kPoseStamped,
  kTransformStamped,
  kPoseWithCovarianceStamped,
  kJointState,
  kWrenchStamped,
  kImage,
  kOperatingState,
  kStringStamped,
  kString,
  kJoints,  ///< JointState, too: its positions, and its efforts after them
};
inline constexpr int kRos2Types = 10;

/// Returns the type as ROS 2 writes it: "geometry_msgs/PoseStamped".
const char* Name(Ros2Type type);
std::optional<Ros2Type> Ros2TypeOf(std::string_view name);

/// Returns the types that are read where messages carry `content`. The first is the one that is
/// written.
std::vector<Ros2Type> Ros2TypesFor(Content content);

}  // namespace flextip::live
