// Each message against the OpenIGTLink library, in both directions.
#include <gmock/gmock.h>
#include <igtlImageMessage.h>
#include <igtlNDArrayMessage.h>
#include <igtlPointMessage.h>
#include <igtlPositionMessage.h>
#include <igtlQuaternionTrackingDataMessage.h>
#include <igtlSensorMessage.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTrackingDataMessage.h>
#include <igtlTransformMessage.h>

#include <limits>
#include <random>

#include "core/error.h"
#include "core/rotation.h"
#include "live/openigtlink/codec.h"
#include "tests/live/openigtlink/peer_messages.h"

namespace flextip::live {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const Eigen::Matrix3d kTurn = ExpRotation(Eigen::Vector3d(0.3, -0.7, 1.1));
const char* const kPeer = "127.0.0.1:18944";

Decoded Decode(const std::vector<std::uint8_t>& bytes) {
  Decoded decoded = DecodeOpenIgtLink(bytes, kPeer);
  EXPECT_EQ(decoded.used, bytes.size());
  return decoded;
}

/// The only message of `bytes`, with its stamp checked.
WireMessage Only(const std::vector<std::uint8_t>& bytes) {
  Decoded decoded = Decode(bytes);
  EXPECT_EQ(decoded.status, DecodeStatus::kDone) << decoded.why;
  EXPECT_EQ(decoded.messages.size(), 1u);
  if (decoded.messages.empty()) return {};
  EXPECT_EQ(decoded.messages[0].t_ns, kStamp_ns);
  return decoded.messages[0];
}

void SetMatrix(igtl::Matrix4x4& to, const Eigen::Matrix3d& R, const Eigen::Vector3d& p_mm) {
  igtl::IdentityMatrix(to);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) to[row][column] = static_cast<float>(R(row, column));
    to[row][3] = static_cast<float>(p_mm[row]);
  }
}

std::vector<std::uint8_t> PeerTransform(const Eigen::Matrix3d& R, const Eigen::Vector3d& p_mm) {
  auto message = igtl::TransformMessage::New();
  igtl::Matrix4x4 matrix;
  SetMatrix(matrix, R, p_mm);
  message->SetMatrix(matrix);
  return Packed(message, "PSM1/measured_cp");
}

TEST(OpenIgtLink, ReadsTransformsInMetres) {
  const WireMessage read = Only(PeerTransform(kTurn, {120.0, -35.5, 7.25}));
  EXPECT_EQ(read.device, "PSM1/measured_cp");
  const auto& transform = std::get<WireTransform>(read.body);
  EXPECT_TRUE(transform.has_orientation);
  EXPECT_LT((transform.T_RD.p - Eigen::Vector3d(0.12, -0.0355, 0.00725)).norm(), 1e-9);
  EXPECT_LT((transform.T_RD.R - kTurn).norm(), 1e-6);
  const Eigen::Matrix3d& R = transform.T_RD.R;
  EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-14);
}

TEST(OpenIgtLink, WritesTransformsInMillimetres) {
  const auto bytes =
      EncodeOpenIgtLink({"PSM1/servo_cp", kStamp_ns, WireTransform{{kTurn, {0.12, -0.0355, 0.5}}}});
  const auto message = Unpacked<igtl::TransformMessage>(bytes);
  ASSERT_TRUE(message.IsNotNull());
  EXPECT_STREQ(message->GetDeviceName(), "PSM1/servo_cp");
  igtl::Matrix4x4 matrix;
  message->GetMatrix(matrix);
  EXPECT_FLOAT_EQ(matrix[0][3], 120.0f);
  EXPECT_FLOAT_EQ(matrix[1][3], -35.5f);
  EXPECT_FLOAT_EQ(matrix[2][3], 500.0f);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      EXPECT_FLOAT_EQ(matrix[row][column], static_cast<float>(kTurn(row, column)));
  unsigned seconds = 0, fraction = 0;
  message->GetTimeStamp(&seconds, &fraction);
  EXPECT_EQ(seconds, 1'700'000'000u);
  EXPECT_NEAR(fraction / 4.294967296, 123'456'789.0, 0.5);
}

TEST(OpenIgtLink, KeepsNamesOf20Bytes) {
  const std::string name = "PSM1/operating_state";
  ASSERT_EQ(name.size(), 20u);
  auto message = igtl::StringMessage::New();
  message->SetString("ENABLED homed");
  EXPECT_EQ(Only(Packed(message, name.c_str())).device, name);
  const auto bytes = EncodeOpenIgtLink({name, kStamp_ns, WireText{"ENABLED homed"}});
  const auto read = Unpacked<igtl::StringMessage>(bytes);
  ASSERT_TRUE(read.IsNotNull());
  EXPECT_EQ(read->GetDeviceName(), name);
  EXPECT_STREQ(read->GetString(), "ENABLED homed");
  EXPECT_EQ(Only(bytes).device, name);
  EXPECT_THROW(EncodeOpenIgtLink({name + "s", kStamp_ns, WireText{"x"}}), InputError);
  EXPECT_THROW(EncodeOpenIgtLink({"", kStamp_ns, WireText{"x"}}), InputError);
}

TEST(OpenIgtLink, ReadsPositionsWithAndWithoutOrientation) {
  const Eigen::Quaternionf q(Eigen::Quaterniond(kTurn).cast<float>());
  // The library writes beyond its memory where it packs the shorter kinds: they are cut here.
  const auto peer = [&](std::size_t body_size) {
    auto message = igtl::PositionMessage::New();
    message->SetPosition(10.0f, 20.0f, -30.0f);
    message->SetQuaternion(q.x(), q.y(), q.z(), q.w());
    std::vector<std::uint8_t> bytes = Packed(message, "em0");
    bytes.resize(IGTL_HEADER_SIZE + body_size);
    Seal(bytes);
    return std::get<WireTransform>(Only(bytes).body);
  };
  for (const std::size_t body_size : {12u, 24u, 28u}) {
    const WireTransform read = peer(body_size);
    const bool oriented = body_size > 12;
    const Eigen::Matrix3d turn = oriented ? kTurn : Eigen::Matrix3d::Identity();
    EXPECT_LT((read.T_RD.p - Eigen::Vector3d(0.01, 0.02, -0.03)).norm(), 1e-9);
    EXPECT_EQ(read.has_orientation, oriented);
    EXPECT_LT((read.T_RD.R - turn).norm(), 1e-5) << body_size;
  }
}

TEST(OpenIgtLink, ReadsEachToolOfTrackingData) {
  auto message = igtl::TrackingDataMessage::New();
  for (int type = 1; type <= 4; ++type) {
    auto tool = igtl::TrackingDataElement::New();
    tool->SetName(fmt::format("tool{}", type).c_str());
    tool->SetType(static_cast<igtlUint8>(type));
    igtl::Matrix4x4 matrix;
    SetMatrix(matrix, kTurn, {100.0 * type, 0.0, 1.0});
    tool->SetMatrix(matrix);
    message->AddTrackingDataElement(tool);
  }
  const Decoded decoded = Decode(Packed(message, "tracker"));
  ASSERT_EQ(decoded.status, DecodeStatus::kDone);
  ASSERT_EQ(decoded.messages.size(), 4u);
  for (int type = 1; type <= 4; ++type) {
    const WireMessage& read = decoded.messages[static_cast<std::size_t>(type) - 1];
    EXPECT_EQ(read.device, fmt::format("tool{}", type));
    EXPECT_EQ(read.t_ns, kStamp_ns);
    const auto& tool = std::get<WireTransform>(read.body);
    EXPECT_EQ(tool.has_orientation, type <= 2);
    EXPECT_LT((tool.T_RD.p - Eigen::Vector3d(0.1 * type, 0.0, 0.001)).norm(), 1e-8);
    EXPECT_LT((tool.T_RD.R - kTurn).norm(), 1e-6);
  }
}

TEST(OpenIgtLink, ReadsEachToolOfQuaternionTrackingData) {
  const Eigen::Quaternionf q(Eigen::Quaterniond(kTurn).cast<float>());
  auto message = igtl::QuaternionTrackingDataMessage::New();
  for (const int type : {2, 3}) {
    auto tool = igtl::QuaternionTrackingDataElement::New();
    tool->SetName(fmt::format("tool{}", type).c_str());
    tool->SetType(static_cast<igtlUint8>(type));
    tool->SetPosition(5.0f, 6.0f, 7.0f);
    tool->SetQuaternion(q.x(), q.y(), q.z(), q.w());
    message->AddQuaternionTrackingDataElement(tool);
  }
  const Decoded decoded = Decode(Packed(message, "tracker"));
  ASSERT_EQ(decoded.messages.size(), 2u);
  for (const WireMessage& read : decoded.messages) {
    const auto& tool = std::get<WireTransform>(read.body);
    EXPECT_LT((tool.T_RD.p - Eigen::Vector3d(0.005, 0.006, 0.007)).norm(), 1e-9);
    EXPECT_LT((tool.T_RD.R - kTurn).norm(), 1e-6);
    EXPECT_EQ(tool.has_orientation, read.device == "tool2");
  }
}

template <class T>
std::vector<double> NumbersOfPeer(int type, std::vector<T> values,
                                  const std::vector<igtlUint16>& size) {
  igtl::Array<T> array;
  array.SetSize(size);
  array.SetArray(values.data());
  auto message = igtl::NDArrayMessage::New();
  message->SetArray(type, &array);
  return std::get<WireNumbers>(Only(Packed(message, "strain0")).body).values;
}

TEST(OpenIgtLink, ReadsArraysOfEveryRealType) {
  using Peer = igtl::NDArrayMessage;
  EXPECT_THAT(NumbersOfPeer<double>(Peer::TYPE_FLOAT64, {1.5, -2e-300, 0.1}, {3}),
              ElementsAre(1.5, -2e-300, 0.1));
  EXPECT_THAT(NumbersOfPeer<float>(Peer::TYPE_FLOAT32, {1.5f, -2.25f}, {2}),
              ElementsAre(1.5, -2.25));
  EXPECT_THAT(NumbersOfPeer<igtlInt16>(Peer::TYPE_INT16, {-300, 300, 1, 2}, {2, 2}),
              ElementsAre(-300, 300, 1, 2));
  EXPECT_THAT(NumbersOfPeer<igtlUint8>(Peer::TYPE_UINT8, {255, 1}, {1, 2}), ElementsAre(255, 1));
  EXPECT_THAT(NumbersOfPeer<igtlInt8>(Peer::TYPE_INT8, {-1, 1}, {2}), ElementsAre(-1, 1));
  EXPECT_THAT(NumbersOfPeer<igtlUint16>(Peer::TYPE_UINT16, {65535}, {1}), ElementsAre(65535));
  EXPECT_THAT(NumbersOfPeer<igtlInt32>(Peer::TYPE_INT32, {-70000}, {1}), ElementsAre(-70000));
  EXPECT_THAT(NumbersOfPeer<igtlUint32>(Peer::TYPE_UINT32, {4000000000u}, {1}),
              ElementsAre(4000000000.0));
}

TEST(OpenIgtLink, WritesArraysTheLibraryReads) {
  const std::vector<double> values{1.0, -0.1, 1e-12, std::numeric_limits<double>::denorm_min()};
  const auto bytes = EncodeOpenIgtLink({"vision0", kStamp_ns, WireNumbers{values}});
  const auto message = Unpacked<igtl::NDArrayMessage>(bytes);
  ASSERT_TRUE(message.IsNotNull());
  ASSERT_EQ(message->GetType(), igtl::NDArrayMessage::TYPE_FLOAT64);
  igtl::ArrayBase* const array = message->GetArray();
  ASSERT_THAT(array->GetSize(), ElementsAre(values.size()));
  EXPECT_EQ(std::memcmp(array->GetRawArray(), values.data(), 8 * values.size()), 0);
  EXPECT_EQ(std::get<WireNumbers>(Only(bytes).body).values, values);
  EXPECT_TRUE(std::get<WireNumbers>(Only(EncodeOpenIgtLink({"n", kStamp_ns, WireNumbers{}})).body)
                  .values.empty());
}

TEST(OpenIgtLink, ReadsSensorsAsTheyStand) {
  auto message = igtl::SensorMessage::New();
  message->SetLength(3);
  igtlFloat64 values[3] = {0.25, -1e-3, 7.0};
  message->SetValue(values);
  EXPECT_THAT(std::get<WireNumbers>(Only(Packed(message, "strain0")).body).values,
              ElementsAre(0.25, -1e-3, 7.0));
}

TEST(OpenIgtLink, ReadsStatusAsText) {
  auto message = igtl::StatusMessage::New();
  message->SetCode(igtl::StatusMessage::STATUS_NOT_READY);
  message->SetSubCode(-7);
  message->SetErrorName("homing");
  message->SetStatusString("wait a moment");
  EXPECT_EQ(std::get<WireText>(Only(Packed(message, "PSM1")).body).text,
            "STATUS 13 -7 homing wait a moment");
}

TEST(OpenIgtLink, PicturesGoBothWays) {
  std::mt19937_64 rng(7);
  for (const int channels : {1, 3}) {
    Image image(7, 5, channels);
    for (auto& byte : image.data) byte = static_cast<std::uint8_t>(rng());
    const auto bytes = EncodeOpenIgtLink({"cam0", kStamp_ns, WireImage{image}});
    const auto message = Unpacked<igtl::ImageMessage>(bytes);
    ASSERT_TRUE(message.IsNotNull());
    int size[3];
    message->GetDimensions(size);
    EXPECT_THAT(size, ElementsAre(7, 5, 1));
    EXPECT_EQ(message->GetNumComponents(), channels);
    EXPECT_EQ(std::memcmp(message->GetScalarPointer(), image.data.data(), image.data.size()), 0);

    auto peer = igtl::ImageMessage::New();
    peer->SetDimensions(7, 5, 1);
    peer->SetSubVolume(7, 5, 1, 0, 0, 0);
    peer->SetNumComponents(channels);
    peer->SetScalarTypeToUint8();
    peer->AllocateScalars();
    std::memcpy(peer->GetScalarPointer(), image.data.data(), image.data.size());
    const Image read = std::get<WireImage>(Only(Packed(peer, "cam0")).body).image;
    EXPECT_EQ(read.width_px, 7);
    EXPECT_EQ(read.height_px, 5);
    EXPECT_EQ(read.channels, channels);
    EXPECT_EQ(read.data, image.data);
  }
}

TEST(OpenIgtLink, LeavesOutTypesWithoutUse) {
  auto message = igtl::PointMessage::New();
  const Decoded decoded = Decode(Packed(message, "points"));
  EXPECT_EQ(decoded.status, DecodeStatus::kIgnored);
  EXPECT_TRUE(decoded.messages.empty());
}

TEST(OpenIgtLink, StampsSurviveToTheNanosecond) {
  std::mt19937_64 rng(11);
  std::uniform_int_distribution<TimeNs> draw(0, 4'294'967'295'999'999'999);
  for (int i = 0; i < 100'000; ++i) {
    const TimeNs t_ns = draw(rng);
    ASSERT_EQ(TimeOfIgtlStamp(IgtlStamp(t_ns)), t_ns);
  }
  EXPECT_EQ(IgtlStamp(0), 0u);
  constexpr TimeNs kLast_ns = 4'294'967'295'999'999'999;
  EXPECT_EQ(TimeOfIgtlStamp(~std::uint64_t{0}), kLast_ns);
  EXPECT_EQ(TimeOfIgtlStamp(IgtlStamp(kLast_ns)), kLast_ns);
  EXPECT_THROW(EncodeOpenIgtLink({"n", kLast_ns + 1, WireText{"x"}}), InputError);
  EXPECT_EQ(TimeOfIgtlStamp(0x80000000u), 500'000'000);
}

TEST(OpenIgtLink, RefusesPosesThatAreNone) {
  Eigen::Matrix3d R = kTurn;
  R.col(0) *= 1.01;
  Decoded decoded = Decode(PeerTransform(R, {0, 0, 0}));
  EXPECT_EQ(decoded.status, DecodeStatus::kRefused);
  EXPECT_THAT(decoded.why, AllOf(HasSubstr(kPeer), HasSubstr("PSM1/measured_cp"),
                                 HasSubstr("expected a rotation")));
  EXPECT_EQ(Decode(PeerTransform(-kTurn, {0, 0, 0})).status, DecodeStatus::kRefused);
  EXPECT_EQ(Decode(PeerTransform(Eigen::Matrix3d::Zero(), {0, 0, 0})).status,
            DecodeStatus::kRefused);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  decoded = Decode(PeerTransform(kTurn, {0.0, nan, 0.0}));
  EXPECT_EQ(decoded.status, DecodeStatus::kRefused);
  EXPECT_THAT(decoded.why, HasSubstr("nan"));
  EXPECT_EQ(Decode(PeerTransform(kTurn, {0.0, INFINITY, 0.0})).status, DecodeStatus::kRefused);
}

TEST(OpenIgtLink, RefusesOneToolAndReadsTheOthers) {
  auto message = igtl::TrackingDataMessage::New();
  for (const char* const name : {"good", "bad", "fine"}) {
    auto tool = igtl::TrackingDataElement::New();
    tool->SetName(name);
    tool->SetType(igtl::TrackingDataElement::TYPE_6D);
    igtl::Matrix4x4 matrix;
    SetMatrix(matrix, std::string(name) == "bad" ? Eigen::Matrix3d(2.0 * kTurn) : kTurn, {1, 2, 3});
    tool->SetMatrix(matrix);
    message->AddTrackingDataElement(tool);
  }
  const Decoded decoded = Decode(Packed(message, "tracker"));
  EXPECT_EQ(decoded.status, DecodeStatus::kRefused);
  EXPECT_THAT(decoded.why, HasSubstr(": bad: "));
  ASSERT_EQ(decoded.messages.size(), 2u);
  EXPECT_EQ(decoded.messages[1].device, "fine");
}

TEST(OpenIgtLink, RefusesNumbersThatAreNone) {
  auto message = igtl::SensorMessage::New();
  message->SetLength(2);
  igtlFloat64 values[2] = {1.0, -INFINITY};
  message->SetValue(values);
  const Decoded decoded = Decode(Packed(message, "strain0"));
  EXPECT_EQ(decoded.status, DecodeStatus::kRefused);
  EXPECT_THAT(decoded.why, AllOf(HasSubstr("strain0"), HasSubstr("-inf as number 2 of 2")));
  EXPECT_THROW(EncodeOpenIgtLink({"n", 1, WireNumbers{{1.0, NAN}}}), InputError);
  EXPECT_THROW(EncodeOpenIgtLink({"n", 1, WireTransform{{kTurn, {0, NAN, 0}}}}), InputError);
  EXPECT_THROW(EncodeOpenIgtLink({"n", 1, WireTransform{{kTurn, {0, 1e40, 0}}}}), InputError);
  EXPECT_THROW(EncodeOpenIgtLink({"n", -1, WireText{"x"}}), InputError);
  EXPECT_THROW(EncodeOpenIgtLink({"n", 1, WireText{std::string(65536, 'x')}}), InputError);
  EXPECT_THROW(EncodeOpenIgtLink({"n", 1, WireNumbers{std::vector<double>(65536)}}), InputError);
  EXPECT_THROW(EncodeOpenIgtLink({"n", 1, WireImage{Image(4, 4, 2)}}), InputError);
}

}  // namespace
}  // namespace flextip::live
