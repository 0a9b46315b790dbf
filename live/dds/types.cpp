#include "live/dds/types.h"

#include <array>

namespace flextip::live {

const char* Name(Ros2Type type) {
  constexpr std::array<const char*, kRos2Types> names{
      "geometry_msgs/PoseStamped",
      "geometry_msgs/TransformStamped",
      "geometry_msgs/PoseWithCovarianceStamped",
      "sensor_msgs/JointState",
      "geometry_msgs/WrenchStamped",
      "sensor_msgs/Image",
      "crtk_msgs/OperatingState",
      "crtk_msgs/StringStamped",
      "std_msgs/String",
      "sensor_msgs/JointState",
  };
  return names[static_cast<std::size_t>(type)];
}

std::optional<Ros2Type> Ros2TypeOf(std::string_view name) {
  for (int i = 0; i < kRos2Types; ++i)
    if (name == Name(static_cast<Ros2Type>(i))) return static_cast<Ros2Type>(i);
  return {};
}

std::vector<Ros2Type> Ros2TypesFor(Content content) {
  switch (content) {
    case Content::kPose:
      return {Ros2Type::kPoseStamped, Ros2Type::kTransformStamped};
    case Content::kTip:
      return {Ros2Type::kPoseWithCovarianceStamped};
    case Content::kMoments:
      return {Ros2Type::kJointState};
    case Content::kForce:
      return {Ros2Type::kWrenchStamped};
    case Content::kPicture:
      return {Ros2Type::kImage};
    case Content::kState:
      return {Ros2Type::kOperatingState};
    case Content::kJoints:
      return {Ros2Type::kJoints};
    case Content::kText:
      break;
  }
  return {Ros2Type::kStringStamped, Ros2Type::kString};
}

}  // namespace flextip::live
