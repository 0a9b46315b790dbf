#include <fmt/format.h>
#include <ros2.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "live/dds/messages.h"
#include "live/dds/tip_covariance.h"
#include "live/protocols/reports.h"

namespace flextip::live {
namespace {

constexpr double kUnitTolerance = 1e-3;
constexpr double kMillimetresPerMetre = 1e3;
constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::size_t kMostNumbers = 1024;
constexpr std::size_t kLongestText = 65535;
constexpr std::size_t kLargestPicture = std::size_t{64} << 20;

std::string_view Text(const char* text) { return text == nullptr ? "" : std::string_view(text); }

/// A message under way: what `Refuse` was told first stays.
struct Reading {
  WireMessage message;
  std::string why;

  void Refuse(std::string reason) {
    if (why.empty()) why = std::move(reason);
  }
};

void ReadStamp(const std_msgs_msg_dds__Header_& header, Reading& reading) {
  const auto& stamp = header.stamp;
  if (stamp.sec < 0 || stamp.nanosec >= kSecond_ns) {
    reading.Refuse(fmt::format("found the stamp {} s {} ns, expected a time from 1970 on",
                               stamp.sec, stamp.nanosec));
    return;
  }
  reading.message.t_ns = stamp.sec * kSecond_ns + stamp.nanosec;
}

template <class Point, class Quaternion>
Pose ReadPose(const Point& p, const Quaternion& q, Reading& reading) {
  const Eigen::Quaterniond q_RD(q.w, q.x, q.y, q.z);
  Pose T_RD;
  T_RD.p = Eigen::Vector3d(p.x, p.y, p.z);
  if (!T_RD.p.allFinite() || !q_RD.coeffs().allFinite()) {
    reading.Refuse(
        fmt::format("found the position {} {} {} and the quaternion {} {} {} {}, "
                    "expected finite numbers",
                    p.x, p.y, p.z, q.x, q.y, q.z, q.w));
    return {};
  }
  if (!(std::abs(q_RD.norm() - 1.0) <= kUnitTolerance)) {
    reading.Refuse(fmt::format("found the quaternion {} {} {} {} of norm {:.6g}, expected 1", q.x,
                               q.y, q.z, q.w, q_RD.norm()));
    return {};
  }
  return Pose::FromQuaternion(q_RD, T_RD.p);
}

void ReadTip(const geometry_msgs_msg_dds__PoseWithCovarianceStamped_& sample, Reading& reading) {
  const auto& pose = sample.pose;
  const Pose T_RE = ReadPose(pose.pose.position, pose.pose.orientation, reading);
  const Eigen::Map<const Matrix6d> covariance(pose.covariance);
  if (!covariance.allFinite()) {
    const double* const odd = std::find_if_not(pose.covariance, pose.covariance + 36,
                                               [](double v) { return std::isfinite(v); });
    reading.Refuse(fmt::format("found {} in the covariance, expected finite numbers", *odd));
    return;
  }
  WireNumbers numbers;
  const auto add = [&](double value) { numbers.values.push_back(value); };
  for (int i = 0; i < 3; ++i) add(kMillimetresPerMetre * T_RE.p[i]);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      add(kMillimetresPerMetre * kMillimetresPerMetre * covariance(row, column));
  const SeenDirection seen = DirectionOf(T_RE.R, covariance);
  for (int i = 0; i < 3; ++i) add(seen.d_RE[i]);
  add(seen.noise_rad);
  if (!std::all_of(numbers.values.begin(), numbers.values.end(),
                   [](double v) { return std::isfinite(v); })) {
    reading.Refuse("found a number that is too large for millimetres");
  }
  reading.message.body = std::move(numbers);
}

void ReadNumbers(const double* values, std::size_t count, const char* what, Reading& reading) {
  if (count == 0 || count > kMostNumbers) {
    reading.Refuse(
        fmt::format("found {} numbers of {}, expected 1 to {}", count, what, kMostNumbers));
    return;
  }
  WireNumbers numbers{{values, values + count}};
  for (const double value : numbers.values)
    if (!std::isfinite(value))
      reading.Refuse(fmt::format("found the {} {}, expected finite numbers", what, value));
  reading.message.body = std::move(numbers);
}

/// Positions, and the efforts after them where there are as many.
void ReadJoints(const sensor_msgs_msg_dds__JointState_& sample, Reading& reading) {
  const auto &position = sample.position, &effort = sample.effort;
  ReadNumbers(position._buffer, position._length, "position", reading);
  if (!reading.why.empty() || effort._length != position._length) return;
  WireNumbers joints = std::get<WireNumbers>(reading.message.body);
  ReadNumbers(effort._buffer, effort._length, "effort", reading);
  const auto& efforts = std::get<WireNumbers>(reading.message.body).values;
  joints.values.insert(joints.values.end(), efforts.begin(), efforts.end());
  reading.message.body = std::move(joints);
}

void ReadForce(const geometry_msgs_msg_dds__WrenchStamped_& sample, Reading& reading) {
  const auto& f = sample.wrench.force;
  const double values[] = {f.x, f.y, f.z};
  ReadNumbers(values, 3, "force", reading);
}

void ReadText(std::string_view text, Reading& reading) {
  if (text.size() > kLongestText)
    reading.Refuse(
        fmt::format("found a text of {} bytes, expected at most {}", text.size(), kLongestText));
  reading.message.body = WireText{std::string(text.substr(0, kLongestText))};
}

void ReadState(const crtk_msgs_msg_dds__OperatingState_& sample, Reading& reading) {
  const std::string_view state = Text(sample.state);
  ReadText(state, reading);
  std::string& text = std::get<WireText>(reading.message.body).text;
  if (sample.is_homed) text += " homed";
  if (sample.is_busy) text += " busy";
}

void ReadPicture(const sensor_msgs_msg_dds__Image_& sample, Reading& reading) {
  const std::string_view encoding = Text(sample.encoding);
  const int channels = encoding == "mono8" ? 1 : encoding == "bgr8" || encoding == "rgb8" ? 3 : 0;
  const std::uint64_t row = std::uint64_t{sample.width} * channels;
  const std::uint64_t size = std::uint64_t{sample.step} * sample.height;
  if (channels == 0 || row == 0 || size == 0 || sample.step < row || size > kLargestPicture ||
      sample.data._length != size) {
    reading.Refuse(
        fmt::format("found a picture of {} x {} '{}', {} bytes a row and {} in all, "
                    "expected mono8, bgr8 or rgb8 and sizes that agree",
                    sample.width, sample.height, Printable(encoding, kShownBytes), sample.step,
                    sample.data._length));
    return;
  }
  WireImage picture{
      Image(static_cast<int>(sample.width), static_cast<int>(sample.height), channels)};
  for (int y = 0; y < picture.image.height_px; ++y) {
    std::uint8_t* const to = picture.image.Row(y);
    std::memcpy(to, sample.data._buffer + std::uint64_t{sample.step} * y, row);
    if (encoding == "rgb8")
      for (std::uint64_t x = 0; x < row; x += 3) std::swap(to[x], to[x + 2]);
  }
  reading.message.body = std::move(picture);
}

template <class Message>
const Message& As(const void* sample) {
  return *static_cast<const Message*>(sample);
}

/// Reads a type that begins with a header.
template <class Message, class Read>
void ReadStamped(const void* sample, Reading& reading, const Read& read) {
  const auto& message = As<Message>(sample);
  ReadStamp(message.header, reading);
  read(message);
}

void ReadSample(Ros2Type type, const void* sample, TimeNs source_ns, Reading& reading) {
  const auto pose = [&](const auto& p, const auto& q) {
    reading.message.body = WireTransform{ReadPose(p, q, reading)};
  };
  switch (type) {
    case Ros2Type::kPoseStamped:
      ReadStamped<geometry_msgs_msg_dds__PoseStamped_>(
          sample, reading, [&](const auto& m) { pose(m.pose.position, m.pose.orientation); });
      break;
    case Ros2Type::kTransformStamped:
      ReadStamped<geometry_msgs_msg_dds__TransformStamped_>(sample, reading, [&](const auto& m) {
        pose(m.transform.translation, m.transform.rotation);
      });
      break;
    case Ros2Type::kPoseWithCovarianceStamped:
      ReadStamped<geometry_msgs_msg_dds__PoseWithCovarianceStamped_>(
          sample, reading, [&](const auto& m) { ReadTip(m, reading); });
      break;
    case Ros2Type::kJointState:
      ReadStamped<sensor_msgs_msg_dds__JointState_>(sample, reading, [&](const auto& m) {
        ReadNumbers(m.effort._buffer, m.effort._length, "effort", reading);
      });
      break;
    case Ros2Type::kJoints:
      ReadStamped<sensor_msgs_msg_dds__JointState_>(sample, reading,
                                                    [&](const auto& m) { ReadJoints(m, reading); });
      break;
    case Ros2Type::kWrenchStamped:
      ReadStamped<geometry_msgs_msg_dds__WrenchStamped_>(
          sample, reading, [&](const auto& m) { ReadForce(m, reading); });
      break;
    case Ros2Type::kImage:
      ReadStamped<sensor_msgs_msg_dds__Image_>(sample, reading,
                                               [&](const auto& m) { ReadPicture(m, reading); });
      break;
    case Ros2Type::kOperatingState:
      ReadStamped<crtk_msgs_msg_dds__OperatingState_>(
          sample, reading, [&](const auto& m) { ReadState(m, reading); });
      break;
    case Ros2Type::kStringStamped:
      ReadStamped<crtk_msgs_msg_dds__StringStamped_>(
          sample, reading, [&](const auto& m) { ReadText(Text(m.text), reading); });
      break;
    case Ros2Type::kString:
      reading.message.t_ns = std::max<TimeNs>(source_ns, 0);
      ReadText(Text(As<std_msgs_msg_dds__String_>(sample).data), reading);
      break;
  }
}

}  // namespace

Ros2Decoded DecodeRos2(Ros2Type type, const void* sample, std::string_view device,
                       TimeNs source_ns) {
  Reading reading;
  reading.message.device = device;
  ReadSample(type, sample, source_ns, reading);
  if (!reading.why.empty())
    return {{}, fmt::format("{}: {}: {}", Printable(device), Name(type), reading.why)};
  return {std::move(reading.message), ""};
}

}  // namespace flextip::live
