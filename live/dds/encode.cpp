#include <fmt/format.h>
#include <ros2.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/robot/crtk.h"
#include "core/rotation.h"
#include "live/dds/messages.h"
#include "live/dds/tip_covariance.h"

namespace flextip::live {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr double kMetresPerMillimetre = 1e-3;
constexpr std::size_t kTipNumbers = 16;

/// Structs of idlc have pointers to what they do not change.
char* Unchanged(const char* text) { return const_cast<char*>(text); }

char* TextOf(const std::string& text, const char* what) {
  if (text.find('\0') != std::string::npos)
    throw InputError(fmt::format("{}: found a character 0 in the text", what));
  return Unchanged(text.c_str());
}

void RequireFinite(const std::vector<double>& values, const std::string& device) {
  for (const double value : values)
    if (!std::isfinite(value))
      throw InputError(fmt::format("{}: found {}, expected finite numbers", device, value));
}

std_msgs_msg_dds__Header_ HeaderOf(const WireMessage& message) {
  const TimeNs s = message.t_ns / kSecond_ns;
  if (message.t_ns < 0 || s > std::numeric_limits<std::int32_t>::max()) {
    throw InputError(fmt::format("{}: found the time {} ns, expected 1970 to 2038", message.device,
                                 message.t_ns));
  }
  std_msgs_msg_dds__Header_ header{};
  header.stamp.sec = static_cast<std::int32_t>(s);
  header.stamp.nanosec = static_cast<std::uint32_t>(message.t_ns % kSecond_ns);
  header.frame_id = Unchanged("R");
  return header;
}

template <class Body>
const Body& BodyOf(Ros2Type type, const WireMessage& message) {
  const auto* const body = std::get_if<Body>(&message.body);
  if (body == nullptr)
    throw InputError(fmt::format("{}: {} does not carry this message", message.device, Name(type)));
  return *body;
}

template <class Point, class Quaternion>
void PutPose(const Eigen::Vector3d& at, const Eigen::Quaterniond& q_RD, Point& p, Quaternion& q) {
  p = {at.x(), at.y(), at.z()};
  q = {q_RD.x(), q_RD.y(), q_RD.z(), q_RD.w()};
}

const Pose& PoseOf(Ros2Type type, const WireMessage& message) {
  const Pose& T_RD = BodyOf<WireTransform>(type, message).T_RD;
  if (!T_RD.Matrix().allFinite())
    throw InputError(fmt::format("{}: found a pose that is not finite", message.device));
  return T_RD;
}

const std::vector<double>& NumbersOf(Ros2Type type, const WireMessage& message, std::size_t least,
                                     std::size_t most) {
  const auto& values = BodyOf<WireNumbers>(type, message).values;
  RequireFinite(values, message.device);
  if (values.size() < least || values.size() > most) {
    throw InputError(fmt::format("{}: found {} numbers, expected {} to {} for {}", message.device,
                                 values.size(), least, most, Name(type)));
  }
  return values;
}

geometry_msgs_msg_dds__PoseWithCovarianceStamped_ TipOf(const WireMessage& message) {
  const auto& v =
      NumbersOf(Ros2Type::kPoseWithCovarianceStamped, message, kTipNumbers, kTipNumbers);
  geometry_msgs_msg_dds__PoseWithCovarianceStamped_ out{};
  out.header = HeaderOf(message);
  const Eigen::Vector3d p_RE = kMetresPerMillimetre * Eigen::Vector3d(v[0], v[1], v[2]);
  SeenDirection seen{Eigen::Vector3d(v[12], v[13], v[14]), v[15]};
  Eigen::Quaterniond q_RE = Eigen::Quaterniond::Identity();
  if (!seen.d_RE.isZero()) {
    seen.d_RE.normalize();
    q_RE = RotationWithoutTwist(Eigen::Vector3d::UnitX(), seen.d_RE);
  }
  PutPose(p_RE, q_RE, out.pose.pose.position, out.pose.pose.orientation);
  Eigen::Map<Matrix6d> covariance(out.pose.covariance);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const std::size_t at = std::size_t{3} + static_cast<std::size_t>(3 * row + column);
      covariance(row, column) = kMetresPerMillimetre * kMetresPerMillimetre * v[at];
    }
  }
  covariance.bottomRightCorner<3, 3>() = CovarianceOf(seen);
  return out;
}

sensor_msgs_msg_dds__Image_ PictureOf(const WireMessage& message) {
  const Image& image = BodyOf<WireImage>(Ros2Type::kImage, message).image;
  sensor_msgs_msg_dds__Image_ out{};
  out.header = HeaderOf(message);
  out.height = static_cast<std::uint32_t>(image.height_px);
  out.width = static_cast<std::uint32_t>(image.width_px);
  out.encoding = Unchanged(image.channels == 1 ? "mono8" : "bgr8");
  out.step = static_cast<std::uint32_t>(image.width_px * image.channels);
  out.data._length = out.data._maximum = static_cast<std::uint32_t>(image.data.size());
  out.data._buffer = const_cast<std::uint8_t*>(image.data.data());
  return out;
}

}  // namespace

void WithRos2(Ros2Type type, const WireMessage& message,
              const std::function<void(const void*)>& use) {
  switch (type) {
    case Ros2Type::kPoseStamped: {
      const Pose& T_RD = PoseOf(type, message);
      geometry_msgs_msg_dds__PoseStamped_ out{};
      out.header = HeaderOf(message);
      PutPose(T_RD.p, T_RD.Quaternion(), out.pose.position, out.pose.orientation);
      return use(&out);
    }
    case Ros2Type::kTransformStamped: {
      const Pose& T_RD = PoseOf(type, message);
      geometry_msgs_msg_dds__TransformStamped_ out{};
      out.header = HeaderOf(message);
      out.child_frame_id = TextOf(message.device, "device");
      PutPose(T_RD.p, T_RD.Quaternion(), out.transform.translation, out.transform.rotation);
      return use(&out);
    }
    case Ros2Type::kPoseWithCovarianceStamped: {
      const auto out = TipOf(message);
      return use(&out);
    }
    case Ros2Type::kJointState: {
      constexpr std::size_t kMostNumbers = 1024;
      const auto& values = NumbersOf(type, message, 1, kMostNumbers);
      sensor_msgs_msg_dds__JointState_ out{};
      out.header = HeaderOf(message);
      out.effort._length = out.effort._maximum = static_cast<std::uint32_t>(values.size());
      out.effort._buffer = const_cast<double*>(values.data());
      return use(&out);
    }
    case Ros2Type::kJoints: {
      constexpr std::size_t kMostNumbers = 1024;
      const auto& values = NumbersOf(type, message, 1, kMostNumbers);
      sensor_msgs_msg_dds__JointState_ out{};
      out.header = HeaderOf(message);
      out.position._length = out.position._maximum = static_cast<std::uint32_t>(values.size());
      out.position._buffer = const_cast<double*>(values.data());
      return use(&out);
    }
    case Ros2Type::kWrenchStamped: {
      const auto& values = NumbersOf(type, message, 3, 3);
      geometry_msgs_msg_dds__WrenchStamped_ out{};
      out.header = HeaderOf(message);
      out.wrench.force = {values[0], values[1], values[2]};
      return use(&out);
    }
    case Ros2Type::kImage: {
      const auto out = PictureOf(message);
      return use(&out);
    }
    case Ros2Type::kOperatingState: {
      const auto& text = BodyOf<WireText>(type, message).text;
      const auto state = CrtkOperatingStateOf(text);
      if (!state)
        throw InputError(fmt::format("{}: found '{}', expected a state", message.device, text));
      crtk_msgs_msg_dds__OperatingState_ out{};
      out.header = HeaderOf(message);
      out.state = Unchanged(Name(state->state));
      out.is_homed = state->is_homed;
      out.is_busy = state->is_busy;
      return use(&out);
    }
    case Ros2Type::kStringStamped: {
      crtk_msgs_msg_dds__StringStamped_ out{};
      out.header = HeaderOf(message);
      out.text = TextOf(BodyOf<WireText>(type, message).text, message.device.c_str());
      return use(&out);
    }
    case Ros2Type::kString: {
      std_msgs_msg_dds__String_ out{};
      out.data = TextOf(BodyOf<WireText>(type, message).text, message.device.c_str());
      return use(&out);
    }
  }
}

}  // namespace flextip::live
