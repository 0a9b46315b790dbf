#include "live/session/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/error.h"
#include "tests/live/session/sample_session.h"

namespace flextip::live {
namespace {

using testing::HasSubstr;

/// Returns the message of reading the session with `from` replaced by `to`; empty for none.
std::string Complaint(const std::string& from, const std::string& to) {
  std::string text = SessionText();
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  try {
    ReadSession(WriteSession(text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Session, SaysWhatTheFileSays) {
  const Session session = ReadSession(WriteSession(SessionText()));
  EXPECT_EQ(session.base.instrument.length_m, 0.6);
  EXPECT_EQ(session.rate_hz, 100.0);
  EXPECT_EQ(session.Of(StreamName::kStrain)->address.device, "strain0");
  EXPECT_EQ(session.Of(StreamName::kWrist)->address.host, "127.0.0.1");
  EXPECT_FALSE(session.Of(StreamName::kEm0));
  EXPECT_TRUE(session.HasTip());
  EXPECT_EQ(session.task.path.waypoints_m.size(), 1u);
  EXPECT_EQ(session.limits.max_speed_m_s, 0.05);
}

TEST(Session, NumbersInAnotherUnitAreRefusedWithTheirLine) {
  EXPECT_THAT(Complaint("length_m: 0.6", "length_m: 600"), HasSubstr("session.yaml:3: "));
  EXPECT_THAT(Complaint("length_m: 0.6", "length_m: 600"), HasSubstr("found 600"));
  EXPECT_THAT(Complaint("max_speed_m_s: 0.05", "max_speed_m_s: 50"), HasSubstr("found 50"));
  EXPECT_THAT(Complaint("speed_m_s: 0.01", "speed_m_s: 10"), HasSubstr("path.speed_m_s"));
  EXPECT_THAT(Complaint("to_m: [0, 0, -0.01]", "to_m: [0, 0, -2]"), HasSubstr("found 2"));
  EXPECT_THAT(Complaint("0.17]", "170]"), HasSubstr("port.position_m"));
  EXPECT_THAT(Complaint("position_noise_m: 0.00005", "position_noise_m: 0.05e3"),
              HasSubstr("found 50"));
}

TEST(Session, AJerkThatCannotBeKeptIsRefused) {
  const std::string limit = "max_acceleration_m_s2: 1.0";
  EXPECT_EQ(Complaint(limit, limit + ", max_jerk_m_s3: 10"), "");
  EXPECT_THAT(Complaint(limit, limit + ", max_jerk_m_s3: 3"), HasSubstr("at least 3.12"));
}

/// The session with the strain gages by another protocol.
std::string StrainBy(const std::string& address) {
  return Complaint("openigtlink: {port: 18944, device: strain0}", address);
}

TEST(Session, EachProtocolHasItsOwnKeys) {
  std::string text = SessionText();
  const std::string before = "openigtlink: {port: 18944, device: strain0}";
  text.replace(text.find(before), before.size(), "ros2: {topic: /arm/strain0, domain: 5}");
  const Session session = ReadSession(WriteSession(text));
  const Address& strain = session.Of(StreamName::kStrain)->address;
  EXPECT_STREQ(strain.protocol->key, "ros2");
  EXPECT_EQ(strain.device, "arm/strain0");
  EXPECT_EQ(strain.port, 5);
  EXPECT_EQ(strain.host, "lo");
  EXPECT_FALSE(strain.SamePeer(session.robot.command));
  EXPECT_EQ(ProtocolKeys(), "openigtlink, ros2 or udp");
}

TEST(Session, AddressesThatAreNoneAreRefused) {
  EXPECT_THAT(StrainBy("ros2: {topic: strain 0}"), HasSubstr("found 'strain 0'"));
  EXPECT_THAT(StrainBy("ros2: {topic: a//b}"), HasSubstr("a topic of ROS 2"));
  EXPECT_THAT(StrainBy("ros2: {topic: /9a}"), HasSubstr("a topic of ROS 2"));
  EXPECT_THAT(StrainBy("ros2: {topic: a, domain: 233}"), HasSubstr("found 233, expected 0 to 232"));
  EXPECT_THAT(StrainBy("ros2: {topic: a, type: std_msgs/String}"),
              HasSubstr("found 'std_msgs/String', expected sensor_msgs/JointState"));
  EXPECT_THAT(StrainBy("ros2: {topic: a, port: 5}"), HasSubstr("port"));
  EXPECT_THAT(StrainBy("udp: {port: 5000, device: a}"), HasSubstr("does not carry this"));
  EXPECT_THAT(StrainBy("openigtlink: {port: 70000, device: a}"), HasSubstr("found 70000"));
  EXPECT_THAT(Complaint("openigtlink: {port: 18944, device: PSM1/servo_cp}",
                        "udp: {port: 5000, device: servo_cp}"),
              HasSubstr("found no peer that takes commands"));
}

TEST(Session, UnknownKeysAreRefused) {
  EXPECT_THAT(Complaint("rate_hz: 100", "rate_hz: 100, rat: 2"),
              HasSubstr("unknown key \"controller.rat\""));
  EXPECT_THAT(Complaint("device: strain0", "device: strain0, dev: 2"), HasSubstr("dev"));
  EXPECT_THAT(Complaint("version: 1", "version: 1\nsauces: {}"), HasSubstr("sauces"));
}

TEST(Session, WhatIsMissingIsNamed) {
  EXPECT_THAT(Complaint("wrist0:", "em1:"), HasSubstr("wrist0"));
  EXPECT_THAT(Complaint("  command: {openigtlink: {port: 18944, device: PSM1/servo_cp}}\n", ""),
              HasSubstr("command"));
  EXPECT_THAT(Complaint("  vision0: {openigtlink: {port: 18944, device: vision0}}\n", ""),
              HasSubstr("needs a tip"));
  EXPECT_THAT(Complaint("kind: rod-track", "kind: rod-trak"), HasSubstr("rod-calculate"));
  EXPECT_THAT(Complaint("flextip-session", "flextip-recording"), HasSubstr("session.yaml:1"));
  EXPECT_THAT(Complaint("port: 18944, device: strain0", "port: 0, device: strain0"),
              HasSubstr("found 0"));
}

TEST(Session, ThoseOfTheDocsAreRead) {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(FLEXTIP_SOURCE_DIR "/testdata/sessions")) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path());
    EXPECT_THAT(ReadSession(entry.path()).warnings, testing::IsEmpty());
    ++files;
  }
  EXPECT_GE(files, 5);
}

}  // namespace
}  // namespace flextip::live
