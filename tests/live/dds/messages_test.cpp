// ROS 2's messages against bytes laid out by hand, there and back again, and what is refused.
#include <gmock/gmock.h>
#include <ros2.h>

#include <cstring>
#include <limits>
#include <type_traits>

#include "core/error.h"
#include "core/rotation.h"
#include "live/dds/messages.h"
#include "tests/live/dds/cdr.h"

namespace flextip::live {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

constexpr TimeNs kTime_ns = 1'700'000'000'000'000'005;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Bytes as XCDR1 has them: little-endian, numbers at multiples of their size.
class Layout {
 public:
  template <class T>
  requires std::is_arithmetic_v<T> Layout& Put(T value) {
    while (bytes_.size() % sizeof value != 0) bytes_.push_back(0);
    bytes_.resize(bytes_.size() + sizeof value);
    std::memcpy(bytes_.data() + bytes_.size() - sizeof value, &value, sizeof value);
    return *this;
  }
  Layout& Put(const std::string& text) {
    Put(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
    bytes_.push_back(0);
    return *this;
  }
  Layout& Header() { return Put(std::int32_t{1'700'000'000}).Put(std::uint32_t{5}).Put("R"); }
  const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

/// What a message is when it has gone through the library's bytes.
WireMessage Again(Ros2Type type, const WireMessage& message) {
  WireMessage read;
  bool was_read = false;
  WithCdr(type, CdrOf(type, message), false, [&](const void* sample) {
    const Ros2Decoded decoded = DecodeRos2(type, sample, message.device, 7);
    EXPECT_EQ(decoded.why, "");
    if (decoded.message) read = *decoded.message;
    was_read = true;
  });
  EXPECT_TRUE(was_read);
  EXPECT_EQ(read.device, message.device);
  return read;
}

/// Why a struct is refused.
template <class Message>
std::string WhyNot(Ros2Type type, const Message& sample) {
  const Ros2Decoded decoded = DecodeRos2(type, &sample, "PSM1/measured_cp", 7);
  EXPECT_FALSE(decoded.message.has_value());
  for (const char c : decoded.why) EXPECT_GE(c, ' ');
  EXPECT_THAT(decoded.why, HasSubstr("PSM1/measured_cp: "));
  return decoded.why;
}

geometry_msgs_msg_dds__PoseStamped_ GoodPose() {
  geometry_msgs_msg_dds__PoseStamped_ sample{};
  sample.header.stamp = {1'700'000'000, 5};
  sample.pose.position = {0.1, -0.2, 0.3};
  sample.pose.orientation = {0.0, 0.0, 0.0, 1.0};
  return sample;
}

TEST(Ros2Messages, NamesOfTypesAreThoseOfRos2) {
  EXPECT_STREQ(WireName(Ros2Type::kPoseStamped), "geometry_msgs::msg::dds_::PoseStamped_");
  EXPECT_STREQ(WireName(Ros2Type::kJointState), "sensor_msgs::msg::dds_::JointState_");
  EXPECT_STREQ(WireName(Ros2Type::kOperatingState), "crtk_msgs::msg::dds_::OperatingState_");
  EXPECT_STREQ(WireName(Ros2Type::kString), "std_msgs::msg::dds_::String_");
}

TEST(Ros2Messages, BytesAreThoseOfXcdr1) {
  const Pose T_RW{ExpRotation(Eigen::Vector3d(0, 0, 1.0)), {0.1, -0.2, 0.3}};
  const Eigen::Quaterniond q = T_RW.Quaternion();
  const Bytes pose = Layout()
                         .Header()
                         .Put(0.1)
                         .Put(-0.2)
                         .Put(0.3)
                         .Put(q.x())
                         .Put(q.y())
                         .Put(q.z())
                         .Put(q.w())
                         .bytes();
  EXPECT_EQ(CdrOf(Ros2Type::kPoseStamped, {"w", kTime_ns, WireTransform{T_RW}}), pose);
  const std::uint32_t none = 0, four = 4;
  const Bytes joints = Layout()
                           .Header()
                           .Put(none)
                           .Put(none)
                           .Put(none)
                           .Put(four)
                           .Put(1.0)
                           .Put(2.0)
                           .Put(3.0)
                           .Put(4.0)
                           .bytes();
  EXPECT_EQ(CdrOf(Ros2Type::kJointState, {"s", kTime_ns, WireNumbers{{1, 2, 3, 4}}}), joints);
  const Bytes state =
      Layout().Header().Put("PAUSED").Put(std::uint8_t{1}).Put(std::uint8_t{0}).bytes();
  EXPECT_EQ(CdrOf(Ros2Type::kOperatingState, {"o", kTime_ns, WireText{"PAUSED homed"}}), state);
}

TEST(Ros2Messages, PosesComeBackInMetres) {
  const Pose T_RD{ExpRotation(Eigen::Vector3d(0.1, 2.0, -0.3)), {0.1, -0.2, 0.3}};
  for (const Ros2Type type : {Ros2Type::kPoseStamped, Ros2Type::kTransformStamped}) {
    const WireMessage read = Again(type, {"PSM1/measured_cp", kTime_ns, WireTransform{T_RD}});
    EXPECT_EQ(read.t_ns, kTime_ns);
    const auto& transform = std::get<WireTransform>(read.body);
    EXPECT_TRUE(transform.has_orientation);
    EXPECT_EQ(transform.T_RD.p, T_RD.p);
    EXPECT_LT((transform.T_RD.R - T_RD.R).norm(), 1e-15);
  }
}

TEST(Ros2Messages, TheTipComesBackWithItsCovarianceAndDirection) {
  const Eigen::Vector3d d = Eigen::Vector3d(1, -2, 0.5).normalized();
  WireNumbers tip{{100, -50, 30, 0.04, 0.01, 0, 0.01, 0.09, 0, 0, 0, 0.25, d[0], d[1], d[2], 0.02}};
  for (const bool has_direction : {true, false}) {
    if (!has_direction) std::fill(tip.values.begin() + 12, tip.values.begin() + 15, 0.0);
    const WireMessage read =
        Again(Ros2Type::kPoseWithCovarianceStamped, {"vision0", kTime_ns, tip});
    const auto& values = std::get<WireNumbers>(read.body).values;
    ASSERT_EQ(values.size(), 16u);
    for (std::size_t i = 0; i < 15; ++i) EXPECT_NEAR(values[i], tip.values[i], 1e-12) << i;
    if (!has_direction) continue;
    EXPECT_NEAR(values[15], 0.02, 1e-12);
  }
}

TEST(Ros2Messages, NumbersStatesTextsAndPicturesComeBack) {
  const WireMessage moments =
      Again(Ros2Type::kJointState, {"strain0", kTime_ns, WireNumbers{{1, 2, 3, 4}}});
  EXPECT_EQ(std::get<WireNumbers>(moments.body).values, (std::vector<double>{1, 2, 3, 4}));
  const WireMessage at = Again(Ros2Type::kJoints, {"js", kTime_ns, WireNumbers{{0.1, -0.2}}});
  EXPECT_EQ(std::get<WireNumbers>(at.body).values, (std::vector<double>{0.1, -0.2}));
  const WireMessage force =
      Again(Ros2Type::kWrenchStamped, {"load0", kTime_ns, WireNumbers{{1, 2, 3}}});
  EXPECT_EQ(std::get<WireNumbers>(force.body).values, (std::vector<double>{1, 2, 3}));
  for (const char* text : {"DISABLED", "ENABLED homed", "PAUSED homed busy", "FAULT busy"}) {
    const WireMessage state = Again(Ros2Type::kOperatingState, {"o", kTime_ns, WireText{text}});
    EXPECT_EQ(std::get<WireText>(state.body).text, text);
  }
  const WireMessage command = Again(Ros2Type::kStringStamped, {"c", kTime_ns, WireText{"enable"}});
  EXPECT_EQ(std::get<WireText>(command.body).text, "enable");
  const WireMessage plain = Again(Ros2Type::kString, {"c", kTime_ns, WireText{"home"}});
  EXPECT_EQ(std::get<WireText>(plain.body).text, "home");
  EXPECT_EQ(plain.t_ns, 7);  // it has no stamp: DDS's
  for (const int channels : {1, 3}) {
    Image image(5, 4, channels);
    for (std::size_t i = 0; i < image.data.size(); ++i)
      image.data[i] = static_cast<std::uint8_t>(7 * i);
    const WireMessage picture = Again(Ros2Type::kImage, {"cam0", kTime_ns, WireImage{image}});
    EXPECT_EQ(std::get<WireImage>(picture.body).image.data, image.data);
  }
}

TEST(Ros2Messages, PicturesInRedGreenBlueAndWithPaddedRowsAreTurned) {
  std::uint8_t bytes[] = {1, 2, 3, 0, 4, 5, 6, 0};
  char encoding[] = "rgb8";
  sensor_msgs_msg_dds__Image_ sample{};
  sample.width = 1, sample.height = 2, sample.step = 4;
  sample.encoding = encoding;
  sample.data._length = sizeof bytes;
  sample.data._buffer = bytes;
  const Ros2Decoded decoded = DecodeRos2(Ros2Type::kImage, &sample, "cam0", 0);
  ASSERT_TRUE(decoded.message) << decoded.why;
  EXPECT_EQ(std::get<WireImage>(decoded.message->body).image.data,
            (std::vector<std::uint8_t>{3, 2, 1, 6, 5, 4}));
}

TEST(Ros2Messages, NumbersThatAreNoneAreRefusedWithTheirValues) {
  auto pose = GoodPose();
  pose.pose.position.y = kNan;
  EXPECT_THAT(WhyNot(Ros2Type::kPoseStamped, pose), HasSubstr("0.1 nan 0.3"));
  pose = GoodPose();
  pose.pose.orientation = {0, 0, 0, 2};
  EXPECT_THAT(WhyNot(Ros2Type::kPoseStamped, pose), HasSubstr("norm 2"));
  geometry_msgs_msg_dds__WrenchStamped_ wrench{};
  wrench.wrench.force.z = kInfinity;
  EXPECT_THAT(WhyNot(Ros2Type::kWrenchStamped, wrench), HasSubstr("inf"));
  geometry_msgs_msg_dds__PoseWithCovarianceStamped_ tip{};
  tip.pose.pose.orientation.w = 1;
  tip.pose.covariance[35] = kNan;
  EXPECT_THAT(WhyNot(Ros2Type::kPoseWithCovarianceStamped, tip), HasSubstr("nan"));
}

TEST(Ros2Messages, StampsThatAreNoneAreRefused) {
  auto pose = GoodPose();
  pose.header.stamp = {-5, 0};
  EXPECT_THAT(WhyNot(Ros2Type::kPoseStamped, pose), HasSubstr("-5 s 0 ns"));
  pose.header.stamp = {5, 1'000'000'000};
  EXPECT_THAT(WhyNot(Ros2Type::kPoseStamped, pose), HasSubstr("1000000000 ns"));
}

TEST(Ros2Messages, EffortsOfJointsComeAfterTheirPositions) {
  std::vector<double> position{0.1, -0.2}, effort{3.0, 4.0, 5.0};
  sensor_msgs_msg_dds__JointState_ joints{};
  joints.header.stamp = {1'700'000'000, 0};
  EXPECT_THAT(WhyNot(Ros2Type::kJoints, joints), HasSubstr("0 numbers of position"));
  joints.position._length = 2;
  joints.position._buffer = position.data();
  joints.effort._length = 2;
  joints.effort._buffer = effort.data();
  const auto numbers = [&] {
    return std::get<WireNumbers>(DecodeRos2(Ros2Type::kJoints, &joints, "js", 7).message->body)
        .values;
  };
  EXPECT_EQ(numbers(), (std::vector<double>{0.1, -0.2, 3.0, 4.0}));
  joints.effort._length = 3;  // of other joints
  EXPECT_EQ(numbers(), (std::vector<double>{0.1, -0.2}));
  joints.effort._length = 2;
  effort[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(WhyNot(Ros2Type::kJoints, joints), HasSubstr("effort nan"));
}

TEST(Ros2Messages, SequencesOfAWrongSizeAreRefused) {
  sensor_msgs_msg_dds__JointState_ joints{};
  EXPECT_THAT(WhyNot(Ros2Type::kJointState, joints), HasSubstr("0 numbers"));
  std::vector<double> many(1025, 1.0);
  joints.effort._length = 1025;
  joints.effort._buffer = many.data();
  EXPECT_THAT(WhyNot(Ros2Type::kJointState, joints), HasSubstr("1025 numbers"));
  std::uint8_t bytes[12] = {};
  char encoding[] = "bgr8\n";
  sensor_msgs_msg_dds__Image_ image{};
  image.width = 2, image.height = 2, image.step = 6;
  image.data._length = 11;
  image.data._buffer = bytes;
  image.encoding = encoding;
  EXPECT_THAT(WhyNot(Ros2Type::kImage, image), HasSubstr("2 x 2 'bgr8?'"));
  encoding[4] = '\0';
  EXPECT_THAT(WhyNot(Ros2Type::kImage, image), HasSubstr("6 bytes a row and 11 in all"));
  image.width = image.height = 0xffffffffu;
  EXPECT_THAT(WhyNot(Ros2Type::kImage, image), HasSubstr("4294967295"));
}

TEST(Ros2Messages, TheLibraryRefusesBytesThatEndEarlyOrLieAboutLengths) {
  const auto is_taken = [](Ros2Type type, const Bytes& bytes) {
    bool taken = false;
    WithCdr(type, bytes, false, [&](const void*) { taken = true; });
    return taken;
  };
  const Bytes pose = CdrOf(Ros2Type::kPoseStamped, {"w", kTime_ns, WireTransform{}});
  EXPECT_TRUE(is_taken(Ros2Type::kPoseStamped, pose));
  for (std::size_t size = 0; size + 8 < pose.size(); ++size)
    EXPECT_FALSE(is_taken(Ros2Type::kPoseStamped, {pose.begin(), pose.begin() + long(size)}));
  const std::uint32_t none = 0, lie = 0x20000000;
  EXPECT_FALSE(is_taken(Ros2Type::kJointState,
                        Layout().Header().Put(none).Put(none).Put(none).Put(lie).Put(1.0).bytes()));
}

TEST(Ros2Messages, WhatATypeDoesNotCarryIsNotWritten) {
  const auto never = [](const void*) { FAIL(); };
  const auto refuses = [&](Ros2Type type, const WireMessage& message) {
    EXPECT_THROW(WithRos2(type, message, never), InputError) << Name(type);
  };
  Pose far;
  far.p.x() = kNan;
  refuses(Ros2Type::kPoseStamped, {"w", kTime_ns, WireTransform{far}});
  refuses(Ros2Type::kPoseStamped, {"w", kTime_ns, WireText{"x"}});
  refuses(Ros2Type::kPoseStamped, {"w", -1, WireTransform{}});
  refuses(Ros2Type::kPoseStamped, {"w", TimeNs{5'000'000'000} * 1'000'000'000, WireTransform{}});
  refuses(Ros2Type::kWrenchStamped, {"l", kTime_ns, WireNumbers{{1, 2}}});
  refuses(Ros2Type::kPoseWithCovarianceStamped, {"v", kTime_ns, WireNumbers{{1, 2, 3}}});
  refuses(Ros2Type::kOperatingState, {"o", kTime_ns, WireText{"DANCING"}});
  refuses(Ros2Type::kStringStamped, {"c", kTime_ns, WireText{std::string("a\0b", 3)}});
}

}  // namespace
}  // namespace flextip::live
